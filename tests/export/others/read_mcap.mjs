// Reads an MCAP file with Foxglove's own reader, in both of its ways, and prints what it found as
// JSON. Fails if the two differ, or if a schema is not that of Foxglove's definitions.
// usage: node read_mcap.mjs NODE_MODULES FILE [MESSAGES]
//   MESSAGES  a file for all messages: lines of JSON, as `cargobay export --jsonl` writes them
import { createRequire } from "node:module";
import { open, readFile, writeFile } from "node:fs/promises";
import path from "node:path";

const [modules, file, messagesFile] = process.argv.slice(2);
const require = createRequire(path.join(modules, "from_here.js"));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const foxglove = require("@foxglove/schemas/jsonschema");

function fail(why) {
  console.error(why);
  process.exit(1);
}

// By the index; messages by their channel and number, which are the same in both ways.
async function indexed() {
  const handle = await open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      const { bytesRead } = await handle.read(buffer, 0, Number(length), Number(offset));
      if (bytesRead !== Number(length)) throw new Error("read beyond the end");
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const messages = new Map();
  let before = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    if (message.logTime < before) fail("messages are not in order of time");
    before = message.logTime;
    messages.set(`${message.channelId} ${message.sequence}`, message.data);
  }
  const metadata = [];
  for await (const each of reader.readMetadata()) metadata.push(Object.fromEntries(each.metadata));
  await handle.close();
  return { reader, messages, metadata };
}

// From the beginning to the end.
async function streamed() {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(await readFile(file));
  const channels = new Map();
  const schemas = new Map();
  const messages = [];
  for (let record; (record = reader.nextRecord()) != undefined; ) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Message") messages.push(record);
  }
  if (!reader.done()) fail("the file does not end");
  if (reader.bytesRemaining() !== 0) fail("there is something after the end");
  return { channels, schemas, messages };
}

// Titles, types and members; not the words.
function shape(schema) {
  const { title, type, properties, items, oneOf, required, minimum, maximum } = schema;
  const named = (object) =>
    object && Object.fromEntries(Object.entries(object).map(([name, one]) => [name, shape(one)]));
  return JSON.stringify({
    title,
    type,
    properties: named(properties),
    items: items && shape(items),
    oneOf: oneOf?.map((one) => [one.title, one.const]),
    required,
    minimum,
    maximum,
  });
}

const { reader, messages: byIndex, metadata } = await indexed();
const { channels, schemas, messages } = await streamed();
const decoder = new TextDecoder("utf-8", { fatal: true });
const counts = {};
const lines = [];
for (const message of messages) {
  const { topic } = channels.get(message.channelId);
  counts[topic] = (counts[topic] ?? 0) + 1;
  const key = `${message.channelId} ${message.sequence}`;
  const same = byIndex.get(key);
  if (!same || Buffer.compare(same, message.data) !== 0) fail(`${topic}: ${key} is not indexed`);
  const text = decoder.decode(message.data);
  JSON.parse(text);
  lines.push(`{"topic":"${topic.slice(1)}",${text.slice(1)}\n`);
}
if (byIndex.size !== messages.length) fail("the index has other messages");
if (reader.statistics.messageCount !== BigInt(messages.length)) fail("wrong statistics");
for (const [id, { topic }] of channels) {
  const counted = reader.statistics.channelMessageCounts.get(id) ?? 0n;
  if (counted !== BigInt(counts[topic] ?? 0)) fail(`wrong statistics of ${topic}`);
}
for (const { name, encoding, data } of schemas.values()) {
  if (encoding !== "jsonschema") fail(`${name} is ${encoding}`);
  const schema = JSON.parse(decoder.decode(data));
  if (!name.startsWith("foxglove.")) continue;
  const theirs = foxglove[name.slice("foxglove.".length)];
  if (!theirs) fail(`Foxglove has no ${name}`);
  if (shape(schema) !== shape(theirs))
    fail(`${name} differs:\n  ${shape(schema)}\n  ${shape(theirs)}`);
}
if (messagesFile) await writeFile(messagesFile, lines.join(""));
console.log(JSON.stringify({ counts, metadata, chunks: reader.chunkIndexes.length }));
