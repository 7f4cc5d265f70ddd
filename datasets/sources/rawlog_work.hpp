#pragma once

#include "datasets/sources/decoding_child.hpp"

namespace clearway {

/// What a DecodingChild does to a rawlog of that many bytes: it decodes what its descriptor (opened, at the
/// start of the log) holds. To be called before the child is made.
DecodingChild::Work rawlog_work(uint64_t file_size);

}  // namespace clearway
