#include "mapping/files/map_digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <stdexcept>

#include "mapping/files/octree_file.hpp"

namespace clearway {

std::string hexadecimal(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned byte : bytes) {
    text += "0123456789abcdef"[byte >> 4U];
    text += "0123456789abcdef"[byte & 15U];
  }
  return text;
}

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 of " + std::to_string(bytes.size()) + " bytes cannot be computed");
  }
  return hexadecimal({digest.data(), length});
}

std::string map_sha256(const Snapshot& map) {
  return sha256(format_fused_tree(map.tree(), map.volumes(), map.seen()));
}

}  // namespace clearway
