#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/system/byte_reader.hpp"

namespace clearway {

/// A frame of a .sens file, for sens_bytes.
struct SensPictures {
  std::array<float, 16> world_from_camera{};  ///< row by row
  std::uint64_t time = 0;                     ///< us
  std::string colour;                         ///< a JPEG
  std::vector<std::uint16_t> depth;           ///< steps of 1 mm
};

/// By zlib.
inline std::string packed(const std::vector<std::uint16_t>& steps) {
  std::string bytes(compressBound(2 * steps.size()), '\0');
  uLongf size = bytes.size();
  compress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(steps.data()),
           2 * steps.size());
  bytes.resize(size);
  return bytes;
}

/// A recording of ScanNet (SensReader, sensorData.h): pictures of depth of 48 x 36, f = 50 and 52, (24, 18),
/// of colours of 96 x 72.
inline std::string sens_bytes(const std::vector<SensPictures>& frames, std::int32_t depth_kind = 1) {
  std::string bytes;
  put(bytes, std::uint32_t{4});
  const std::string sensor = "StructureSensor";
  put(bytes, std::uint64_t{sensor.size()});
  bytes += sensor;
  const auto put_all = [&bytes](std::initializer_list<float> numbers) {
    for (const float number : numbers) put(bytes, number);
  };
  put_all({100, 0, 48, 0, 0, 104, 36, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  put_all({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  put_all({50, 0, 24, 0, 0, 52, 18, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  put_all({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  put(bytes, std::int32_t{2});
  put(bytes, depth_kind);
  for (const std::uint32_t side : {96U, 72U, 48U, 36U}) put(bytes, side);
  put(bytes, 1000.0F);
  put(bytes, std::uint64_t{frames.size()});
  for (const SensPictures& frame : frames) {
    for (const float number : frame.world_from_camera) put(bytes, number);
    put(bytes, frame.time);
    put(bytes, frame.time);
    std::string depth(reinterpret_cast<const char*>(frame.depth.data()), 2 * frame.depth.size());
    if (depth_kind == 1) depth = packed(frame.depth);
    put(bytes, std::uint64_t{frame.colour.size()});
    put(bytes, std::uint64_t{depth.size()});
    bytes += frame.colour + depth;
  }
  put(bytes, std::uint64_t{0});  // of an IMU
  return bytes;
}

}  // namespace clearway
