// Writes an MCAP file of every kind of message that Clearway reads: node write_bag.mjs FILE cdr|ros1 none|lz4|zstd
// A camera "camera" on a robot "base" that goes along x of "map" at 1 m/s, from second 100 to 104.
import { writeFileSync } from "node:fs";
import { McapWriter } from "@mcap/core";
import lz4 from "lz4js";
import zstd from "@foxglove/wasm-zstd";

import { ros1, ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageWriter as Ros1Writer } from "@foxglove/rosmsg-serialization";
import { MessageWriter as Ros2Writer } from "@foxglove/rosmsg2-serialization";

const [file, wire, compression, ending] = process.argv.slice(2);
const isRos2 = wire === "cdr";
const definitions = Object.values(isRos2 ? ros2humble : ros1);

/** The definition of a type with all that it is made of. */
function withParts(type) {
  const found = [];
  const add = (name) => {
    const definition = definitions.find((d) => d.name === name || d.name?.replace("/msg/", "/") === name);
    if (!definition || found.includes(definition)) return;
    found.push(definition);
    for (const field of definition.definitions) if (field.isComplex) add(field.type);
  };
  add(type);
  return found;
}

const chunks = {
  none: undefined,
  lz4: (data) => ({ compression: "lz4", compressedData: lz4.compress(data) }),
  zstd: (data) => ({ compression: "zstd", compressedData: zstd.compress(data) }),
};
await zstd.isLoaded;

const parts = [];
let position = 0n;
const writer = new McapWriter({
  writable: {
    position: () => position,
    write: async (data) => { parts.push(data.slice()); position += BigInt(data.length); },
  },
  chunkSize: 2000,
  compressChunk: chunks[compression],
});
await writer.start({ profile: wire === "cdr" ? "ros2" : "ros1", library: "clearway tests" });

const channels = new Map();
async function channelOf(topic, type) {
  if (channels.has(topic)) return channels.get(topic);
  const name = isRos2 ? type.replace("/", "/msg/") : type;
  const all = withParts(type);
  const schemaId = await writer.registerSchema({ name, encoding: isRos2 ? "ros2msg" : "ros1msg", data: new Uint8Array() });
  const id = await writer.registerChannel({ schemaId, topic, messageEncoding: wire, metadata: new Map() });
  const channel = { id, writer: isRos2 ? new Ros2Writer(all) : new Ros1Writer(all), sequence: 0 };
  channels.set(topic, channel);
  return channel;
}

const stamp = (t) => {
  const sec = Math.floor(t), rest = Math.round((t - sec) * 1e9);
  return isRos2 ? { sec, nanosec: rest } : { sec, nsec: rest };
};
const header = (t, frame_id) => ({ seq: 7, stamp: stamp(t), frame_id });
async function write(topic, type, recorded, message) {
  const channel = await channelOf(topic, type);
  const time = BigInt(Math.round(recorded * 1e6)) * 1000n;
  await writer.addMessage({ channelId: channel.id, sequence: channel.sequence++, logTime: time, publishTime: time,
    data: channel.writer.writeMessage(message) });
}

const transform = (t, parent, child, x, y, z, q) => ({ header: header(t, parent), child_frame_id: child,
  transform: { translation: { x, y, z }, rotation: { x: q[0], y: q[1], z: q[2], w: q[3] } } });
const optical = [-0.5, 0.5, -0.5, 0.5];  // z forward, x right of a frame with x forward
await write("/tf_static", "tf2_msgs/TFMessage", 99.5,
  { transforms: [transform(99.5, "base", "camera", 0.1, 0.2, 0.5, optical), transform(99.5, "base", "laser", 0, 0, 0.3, [0, 0, 0, 1])] });
const info = { header: header(99.6, "camera"), height: 3, width: 4, distortion_model: "plumb_bob" };
const K = [100, 0, 1.5, 0, 110, 1, 0, 0, 1], R = [1, 0, 0, 0, 1, 0, 0, 0, 1], P = [100, 0, 1.5, 0, 0, 110, 1, 0, 0, 0, 1, 0];
const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
const more = { binning_x: 0, binning_y: 0, roi };
const D = [0.1, -0.2, 0.001, 0.002, 0.03];
await write("/camera/camera_info", "sensor_msgs/CameraInfo", 99.6,
  { ...info, ...more, ...(isRos2 ? { d: D, k: K, r: R, p: P } : { D, K, R, P }) });
for (let i = 0; i <= 8; ++i) {
  const t = 100 + 0.5 * i;
  await write("/tf", "tf2_msgs/TFMessage", t, { transforms: [transform(t, "map", "base", t - 100, 0, 0, [0, 0, 0, 1])] });
}
for (let i = 0; i < 4; ++i) {
  const t = 100.25 + i;
  const image = (encoding, step, data) => ({ header: header(t, "camera"), height: 3, width: 4, encoding, is_bigendian: 0, step, data });
  const gray = Uint8Array.from({ length: 18 }, (_, k) => (k % 6 < 4 ? 10 * i + k : 255));  // rows padded to 6 bytes
  await write("/camera/image", "sensor_msgs/Image", t + 0.02, image("mono8", 6, gray));
  const depth = new Uint16Array(12).map((_, k) => (k === 5 ? 0 : 1000 + 10 * k + i));
  await write("/camera/depth", "sensor_msgs/Image", t + 0.02, image("16UC1", 8, new Uint8Array(depth.buffer)));
  const floats = new Float32Array([1, 2, 3, 9, NaN, 0, 0, 9, 4, 5, 6, 9, 0, 0, 0, 9, -1, -2, i, 9]);
  const fields = ["x", "y", "z", "intensity"].map((name, k) => ({ name, offset: 4 * k, datatype: 7, count: 1 }));
  await write("/points", "sensor_msgs/PointCloud2", t + 0.03, { header: header(t, "laser"), height: 1, width: 5, fields,
    is_bigendian: false, point_step: 16, row_step: 80, data: new Uint8Array(floats.buffer), is_dense: false });
  await write("/scan", "sensor_msgs/LaserScan", t - 0.01, { header: header(t, "laser"), angle_min: -0.5, angle_max: 0.5,
    angle_increment: 0.5, time_increment: 0, scan_time: 0, range_min: 0.1, range_max: 30,
    ranges: new Float32Array([2, Infinity, 4]), intensities: new Float32Array() });
  await write("/joint_states", "sensor_msgs/JointState", t, { header: header(t, ""), name: ["shoulder", "elbow"],
    position: new Float64Array([0.5 * i, -1]), velocity: new Float64Array(), effort: new Float64Array() });
}
await writer.end();
let bytes = Buffer.concat(parts);
if (ending === "unended") {  // as a recorder leaves it that is killed: without summary, within a record
  const dataEnd = bytes.lastIndexOf(Buffer.from([0x0f, 4, 0, 0, 0, 0, 0, 0, 0]));
  bytes = bytes.subarray(0, dataEnd + 3);
}
writeFileSync(file, bytes);
