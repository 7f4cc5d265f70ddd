// Reads what `clearway replay --record FILE` wrote, with every checksum, and prints how many messages each topic has:
// npm ci && node read_record.mjs FILE
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import rosmsg from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

await zstd.isLoaded;
const file = await open(process.argv[2]);
const size = (await file.stat()).size;
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await file.read(bytes, 0, Number(length), Number(offset));
    return bytes;
  },
};
const reader = await McapIndexedReader.Initialize({ readable,
  decompressHandlers: { zstd: (bytes, length) => zstd.decompress(bytes, Number(length)) } });
const counts = {}, decoders = {};
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId), schema = reader.schemasById.get(channel.schemaId);
  decoders[channel.id] ??= new MessageReader(rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true }));
  decoders[channel.id].readMessage(message.data);
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
}
console.log(JSON.stringify(counts));
await file.close();
