"""Raw HTTP and WebSocket over sockets, which can also be wrong on purpose."""
import base64
import os
import re
import socket
import ssl
import struct
import subprocess


class Server:
    """cargobay-web, started and ended."""

    def __init__(self, program, *options, env=None):
        self.process = subprocess.Popen([program, *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True,
                                        env={**os.environ, **(env or {})})
        self.line = self.process.stdout.readline()
        found = re.match(r"serving (https?)://([^/]*):(\d+)/(login#token=(.*))?$", self.line)
        if not found:
            self.process.wait(10)
            raise RuntimeError(f"{self.line!r} {self.process.stderr.read()}")
        self.encrypted = found[1] == "https"
        self.host, self.port, self.token = found[2], int(found[3]), found[5]

    def connect(self, timeout=10):
        link = socket.create_connection(("127.0.0.1", self.port), timeout)
        if self.encrypted:
            context = ssl.create_default_context()
            context.check_hostname = False
            context.verify_mode = ssl.CERT_NONE
            link = context.wrap_socket(link)
        return link

    def request(self, path="/", method="GET", body=b"", **headers):
        """Status, headers (lower case), body."""
        headers = {"Host": f"127.0.0.1:{self.port}", "Connection": "close",
                   **{name.replace("_", "-"): value for name, value in headers.items()}}
        if body:
            headers["Content-Length"] = str(len(body))
        head = f"{method} {path} HTTP/1.1\r\n" + "".join(
            f"{name}: {value}\r\n" for name, value in headers.items() if value is not None)
        with self.connect() as link:
            link.sendall(head.encode("latin-1") + b"\r\n" + body)
            return parse(read_all(link))

    def memory_kb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1])

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def end(self):
        self.process.terminate()
        code = self.process.wait(10)
        self.process.stdout.close()
        self.errors = self.process.stderr.read()
        self.process.stderr.close()
        return code


def read_all(link):
    data = b""
    try:
        while chunk := link.recv(65536):
            data += chunk
    except (ConnectionResetError, TimeoutError):
        pass
    return data


def parse(data):
    head, _, body = data.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    status = int(lines[0].split()[1]) if len(lines[0].split()) > 1 else 0
    headers = {}
    for line in lines[1:]:
        name, _, value = line.partition(":")
        headers[name.strip().lower()] = value.strip()
    return status, headers, body


class WebSocket:
    """A client's end. `status` is that of the handshake; 0: hung up."""

    def __init__(self, server, path="/api/feed", protocol=None, **headers):
        self.link = server.connect()
        self.buffer = b""
        headers = {"Host": f"127.0.0.1:{server.port}", "Upgrade": "websocket",
                   "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
                   "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
                   "Sec-WebSocket-Protocol": protocol,
                   **{name.replace("_", "-"): value for name, value in headers.items()}}
        head = f"GET {path} HTTP/1.1\r\n" + "".join(
            f"{name}: {value}\r\n" for name, value in headers.items() if value is not None)
        self.link.sendall(head.encode("latin-1") + b"\r\n")
        while b"\r\n\r\n" not in self.buffer:
            try:
                chunk = self.link.recv(65536)
            except ConnectionResetError:
                chunk = b""
            if not chunk:
                break
            self.buffer += chunk
        self.status, self.headers, rest = parse(self.buffer) if self.buffer else (0, {}, b"")
        self.buffer = rest

    def send(self, payload, opcode=1, fin=True, masked=True, reserved=0):
        if isinstance(payload, str):
            payload = payload.encode()
        self.link.sendall(frame(payload, opcode, fin, masked, reserved))

    def bytes(self, count):
        while len(self.buffer) < count:
            chunk = self.link.recv(65536)
            if not chunk:
                raise ConnectionError("closed")
            self.buffer += chunk
        result, self.buffer = self.buffer[:count], self.buffer[count:]
        return result

    def receive(self):
        """Opcode and payload of the next frame."""
        first, second = self.bytes(2)
        length = second & 0x7F
        if length == 126:
            length, = struct.unpack(">H", self.bytes(2))
        elif length == 127:
            length, = struct.unpack(">Q", self.bytes(8))
        return first & 0xF, self.bytes(length)

    def until_closed(self):
        """The code with which the server closes; None if it just hangs up."""
        try:
            while True:
                opcode, payload = self.receive()
                if opcode == 8:
                    return struct.unpack(">H", payload[:2])[0] if len(payload) > 1 else 0
                if opcode == 9:
                    self.send(payload, 10)
        except (ConnectionError, OSError):
            return None

    def close(self):
        self.link.close()


def frame(payload, opcode=1, fin=True, masked=True, reserved=0, length=None):
    length = len(payload) if length is None else length
    head = bytes([(0x80 if fin else 0) | reserved | opcode])
    mask_bit = 0x80 if masked else 0
    if length < 126:
        head += bytes([mask_bit | length])
    elif length < 65536:
        head += bytes([mask_bit | 126]) + struct.pack(">H", length)
    else:
        head += bytes([mask_bit | 127]) + struct.pack(">Q", length)
    if not masked:
        return head + payload
    mask = os.urandom(4)
    return head + mask + bytes(byte ^ mask[i & 3] for i, byte in enumerate(payload))
