#include "mapping/files/map_digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "mapping/files/octree_file.hpp"
#include "mapping/system/plain_text.hpp"

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

std::string file_sha256(const std::filesystem::path& file) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  std::ifstream stream(file, std::ios::binary);
  bool is_good = stream.is_open() && context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> piece(std::size_t{1} << 20U);
  while (is_good && stream.good()) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    is_good = EVP_DigestUpdate(context.get(), piece.data(), static_cast<std::size_t>(stream.gcount())) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (!is_good || stream.bad() || EVP_DigestFinal_ex(context.get(), digest.data(), &length) != 1)
    throw std::runtime_error(quote_path(file.string()) + " cannot be read");
  return hexadecimal({digest.data(), length});
}

std::string map_sha256(const Snapshot& map) {
  return sha256(format_fused_tree(map.tree(), map.volumes(), map.seen()));
}

}  // namespace clearway
