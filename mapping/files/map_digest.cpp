#include "mapping/files/map_digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <stdexcept>

#include "mapping/files/octree_file.hpp"

namespace clearway {

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 of " + std::to_string(bytes.size()) + " bytes cannot be computed");
  }
  std::string text;
  for (unsigned i = 0; i < length; ++i) {
    text += "0123456789abcdef"[digest[i] >> 4U];
    text += "0123456789abcdef"[digest[i] & 15U];
  }
  return text;
}

std::string map_sha256(const Snapshot& map) {
  return sha256(format_fused_tree(map.tree(), map.volumes(), map.seen()));
}

}  // namespace clearway
