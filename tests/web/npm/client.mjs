// Foxglove's own client: subscribes to every channel, and does all that a client can. Prints what
// it saw as one JSON object.
// usage: client.mjs URL SUBPROTOCOL
import protocols from "@foxglove/ws-protocol";
import { WebSocket } from "ws";

const { FoxgloveClient } = protocols;

const [, , url, protocol] = process.argv;
const seen = { channels: [], messages: [], status: [], parameters: [], services: [], answers: [],
  failures: [], errors: [] };
const socket = new WebSocket(url, [protocol]);
const client = new FoxgloveClient({ ws: socket });
const topics = new Map(); // of subscriptions
const text = (data) => Buffer.from(data.buffer, data.byteOffset, data.byteLength).toString();

client.on("error", (error) => seen.errors.push(String(error)));
client.on("status", ({ message }) => seen.status.push(message));
client.on("serverInfo", (info) => (seen.server = info));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    JSON.parse(channel.schema);
    seen.channels.push({ topic: channel.topic, schema: channel.schemaName });
    topics.set(client.subscribe(channel.id), channel.topic);
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) =>
  seen.messages.push({ topic: topics.get(subscriptionId), ns: String(timestamp), text: text(data) }));
client.on("advertiseServices", (services) => {
  seen.services = services.map(({ name }) => name);
  steer();
  const { id } = services.find(({ name }) => name === "/stop");
  client.sendServiceCallRequest({ serviceId: id, callId: 7, encoding: "json",
    data: new TextEncoder().encode("{}") });
});
client.on("serviceCallResponse", ({ callId, data }) => seen.answers.push([callId, text(data)]));
client.on("serviceCallFailure", ({ message }) => seen.failures.push(message));
client.on("parameterValues", ({ parameters, id }) => seen.parameters.push({ parameters, id }));

function steer() {
  client.setParameters([{ name: "steer.name", value: "Ada" }], "set");
  const channel = client.advertise({ topic: "/cmd_vel", encoding: "json",
    schemaName: "geometry_msgs/Twist" });
  const twist = { linear: { x: 0.25, y: 0, z: 0 }, angular: { x: 0, y: 0, z: -0.5 } };
  client.sendMessage(channel, new TextEncoder().encode(JSON.stringify(twist)));
}

// The constants are known when the feed has said them.
let asked = false;
function isComplete() {
  const count = (topic) => seen.messages.filter((message) => message.topic === topic).length;
  if (!asked && count("/hello") > 0) client.getParameters([], "all");
  asked ||= count("/hello") > 0;
  return seen.answers.length + seen.failures.length > 0 && count("/state") > 60 &&
    seen.parameters.some(({ id }) => id === "all") &&
    [...topics.values()].every((topic) => count(topic) > 0);
}

const end = Date.now() + 60000;
const timer = setInterval(() => {
  if (!isComplete() && Date.now() < end) return;
  clearInterval(timer);
  process.stdout.write(JSON.stringify(seen), () => process.exit(0));
}, 50);
