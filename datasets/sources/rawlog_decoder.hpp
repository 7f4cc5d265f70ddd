#pragma once

#include <functional>
#include <memory>
#include <string>

#include "datasets/sources/frame_bytes.hpp"

namespace clearway {

/// Turns the MRPT objects of a rawlog into frames. MRPT is not safe on damaged input (it may crash or ask for
/// gigabytes), so this runs only in the decoding child.
class RawlogDecoder {
 public:
  /// Fills its target as far as there are bytes and returns how many these were.
  using ReadBytes = std::function<size_t(void*, size_t)>;
  explicit RawlogDecoder(ReadBytes read);
  ~RawlogDecoder();

  /// Reads one object and hands its frames to `frame`, and one sentence to `skipped` (empty for a kind of
  /// observation Clearway has no use for) for each observation left out.
  /// @throws std::exception whatever MRPT throws on damage; DamagedStream.
  void decode_object(const std::function<void(DecodedFrame&&)>& frame,
                     const std::function<void(const std::string&)>& skipped);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Makes MRPT know the classes of the libraries we use; without it a static build reads none of them.
void register_rawlog_classes();

}  // namespace clearway
