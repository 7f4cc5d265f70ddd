#include "mapping/files/octree_stream.hpp"

#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <stdexcept>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/files/octree_nodes.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 18U;

/// SHA-256 of bytes that come in pieces.
class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    require(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void add(std::string_view bytes) {
    require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
  }
  std::string text() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned length = 0;
    require(EVP_DigestFinal_ex(context_.get(), digest.data(), &length) == 1);
    return hexadecimal({digest.data(), length});
  }

 private:
  static void require(bool done) {
    if (!done) throw std::runtime_error("SHA-256 of a map file cannot be computed");
  }
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

/// What NodeReader asks of a sink; places are cubes.
struct LeafSink {
  const std::function<void(const FusedNode&, const CellCube&)>& visit;

  CellCube root() const { return {}; }
  CellCube child(const CellCube& cube, unsigned index) const { return cube.child(index); }
  void leaf(const CellCube& cube, const FileLeaf& leaf) const {
    FusedNode node;
    if (leaf.observed) node.observe(leaf.log_odds);
    node.add_paint(leaf.painted);
    visit(node, cube);
  }
  void close(const CellCube&) const {}
};

}  // namespace

OctreeStream::OctreeStream(const std::filesystem::path& file)
    : file_(file), input_(file, "map file"), header_(read_header()) {
  bool sealed = digest();
  checked_ = check_octree_start(header_, file_, [&] { return sealed; });
  first_ = static_cast<std::size_t>(checked_.data.data() - header_.data());
  const std::size_t looks = seen_bytes(checked_, input_.size() - first_, file_);
  last_ = input_.size() - looks;
  if (looks > 0) {
    std::string bytes;
    input_.read_at(last_, looks, bytes);
    seen_ = std::make_shared<const SeenStamps>(parse_seen(bytes, file_));
  }
  bare_ = std::make_shared<FusedTree>(checked_.resolution);
  volumes_ = restore_header(*bare_, checked_, file_);
}

std::string OctreeStream::read_header() const {
  std::string start;
  for (std::size_t size = piece_bytes;; size *= 4) {
    input_.read_at(0, std::min(size, input_.size()), start);
    if (!start.starts_with('#')) return start;  // numbers, or damage
    const auto end = start.find("\ndata\n");
    if (end != std::string::npos) start.resize(end + 6);
    if (end != std::string::npos || size >= input_.size()) return start;
  }
}

bool OctreeStream::digest() {
  Digest digest;
  auto checksum = crc32_z(0, nullptr, 0);
  const auto check = [&](std::string_view bytes) {
    checksum = crc32_z(checksum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  };
  // The seal is of all bytes but its own line, the second, which lies in the header.
  const std::size_t first = header_.find('\n') + 1, second = header_.find('\n', first) + 1;
  const bool has_line = first > 0 && second > 0;
  for (std::size_t at = 0; at < input_.size();) {
    input_.read_at(at, std::min(piece_bytes, input_.size() - at), piece_);
    if (piece_.empty()) throw DamagedFile("'" + file_.string() + "' became shorter while it was read");
    digest.add(piece_);
    const std::string_view piece(piece_);
    if (has_line && at < second) {
      if (at < first) check(piece.substr(0, first - at));
      if (at + piece.size() > second) check(piece.substr(second - at));
    } else {
      check(piece);
    }
    at += piece.size();
  }
  sha256_ = digest.text();
  return has_line &&
         header_.substr(first, second - first) == seal_line(checksum, input_.size() - (second - first));
}

void OctreeStream::visit_leaves(const std::function<void(const FusedNode&, const CellCube&)>& visit) const {
  std::size_t at = first_;
  NodeBytes bytes({}, file_, [&]() -> std::string_view {
    input_.read_at(at, std::min(piece_bytes, last_ - at), piece_);
    at += piece_.size();
    return piece_;
  });
  LeafSink sink{visit};
  read_nodes(checked_, bytes, sink, bare_->getClampingThresMinLog(), bare_->getClampingThresMaxLog());
}

}  // namespace clearway
