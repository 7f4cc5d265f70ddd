// Reads what `clearway replay --record FILE` wrote, with every checksum, and prints how many messages each topic has:
// npm ci && node read_record.mjs FILE [TRUTH.json]
// With the truth of a simulated recording, poses of camera, probe and a tag of it must be true, covariances sound.
import { open, readFile } from "node:fs/promises";
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
const counts = {}, decoders = {}, messages = {};
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId), schema = reader.schemasById.get(channel.schemaId);
  decoders[channel.id] ??= new MessageReader(rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true }));
  (messages[channel.topic] ??= []).push(decoders[channel.id].readMessage(message.data));
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
}
console.log(JSON.stringify(counts));
await file.close();

function fail(text) {
  console.error(text);
  process.exit(1);
}
const secondsOf = ({ stamp }) => stamp.sec + 1e-9 * (stamp.nsec ?? stamp.nanosec);
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const list = ({ x, y, z }) => [x, y, z];
/** The point on the z axis of a pose x, y, z, qw, qx, qy, qz. */
const along = ([x, y, z, w, i, j, k], length) =>
  [x + 2 * length * (i * k + w * j), y + 2 * length * (j * k - w * i), z + length * (1 - 2 * (i * i + j * j))];

if (process.argv[3]) {
  const frames = JSON.parse(await readFile(process.argv[3])).frames;
  const truthAt = (header) => frames.find((frame) => Math.abs(frame.time - secondsOf(header)) < 1e-6) ?? fail("no such time");
  const near = (place, truth, what) => {
    if (!(distance(place, truth) < 0.005)) fail(`${what} is ${place}, expected ${truth}`);
  };
  for (const what of ["camera", "probe"]) {
    for (const { header, pose } of messages[`/poses/${what}`]) {
      const truth = truthAt(header)[`map_from_${what}`], { position, orientation: q } = pose.pose;
      if (header.frame_id !== "map") fail(`frame ${header.frame_id}`);
      near(list(position), truth, what);
      const cosine = Math.abs(q.w * truth[3] + q.x * truth[4] + q.y * truth[5] + q.z * truth[6]);
      if (!(cosine > Math.cos(0.02))) fail(`${what} is turned by ${2 * Math.acos(cosine)}`);
      const c = pose.covariance;
      for (let i = 0; i < 36; ++i) {
        if (Math.abs(c[i] - c[6 * (i % 6) + Math.floor(i / 6)]) > 1e-12) fail("a covariance is not symmetric");
        if (i % 7 === 0 && !(c[i] > 0 && c[i] < 0.01)) fail(`a variance of ${c[i]}`);
      }
    }
  }
  let tags = 0;
  for (const { header, child_frame_id, transform } of messages["/tf"].flatMap((message) => message.transforms)) {
    if (child_frame_id !== "tag36h11:10") continue;  // on the probe's z axis, 25 mm from its middle
    near(list(transform.translation), along(truthAt(header).map_from_probe, 0.025), child_frame_id);
    ++tags;
  }
  if (tags === 0) fail("no tag in /tf");
  for (const info of messages["/camera/camera_info"]) {
    if (info.distortion_model !== "plumb_bob" || info.d[0] !== -0.12 || info.k[4] !== 331 || info.p[5] !== 331 ||
        info.width !== 320 || info.roi.do_rectify) fail(`camera ${JSON.stringify(info)}`);
  }
}
