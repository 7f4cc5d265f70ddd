#include "mapping/history/touched_cells.hpp"

#include <zlib.h>

#include <bit>
#include <span>
#include <stdexcept>

namespace clearway {
namespace {

constexpr std::size_t cubes = 64;          // of 8 x 8 x 8 cells in a tile
constexpr std::size_t words_per_cube = 8;  // of 4 x 4 x 4 cells
constexpr std::uint64_t all = ~std::uint64_t{0};

enum Code : unsigned { none = 0, every = 1, some = 2 };

Code code_of(std::span<const std::uint64_t> words) {
  bool any = false, full = true;
  for (const std::uint64_t word : words) {
    any |= word != 0;
    full &= word == all;
  }
  return full ? every : any ? some : none;
}

void put(std::string& bytes, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i & 0xffU);
}

void pack_tile(const Eigen::Vector3i& corner, std::span<const std::uint64_t> words, std::string& bytes) {
  if (code_of(words) == none) return;
  for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<std::uint16_t>(corner[axis]), 2);
  std::array<Code, cubes> codes{};
  for (std::size_t cube = 0; cube < cubes; ++cube)
    codes[cube] = code_of(words.subspan(cube * words_per_cube, words_per_cube));
  for (std::size_t i = 0; i < cubes; i += 4)
    put(bytes, codes[i] | codes[i + 1] << 2U | codes[i + 2] << 4U | codes[i + 3] << 6U, 1);
  for (std::size_t cube = 0; cube < cubes; ++cube) {
    if (codes[cube] != some) continue;
    const auto part = words.subspan(cube * words_per_cube, words_per_cube);
    unsigned of_words = 0;
    for (std::size_t i = 0; i < words_per_cube; ++i) of_words |= code_of(part.subspan(i, 1)) << 2 * i;
    put(bytes, of_words, 2);
    for (const std::uint64_t word : part) {
      if (word != 0 && word != all) put(bytes, word, 8);
    }
  }
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), 1) != Z_OK) {
    throw std::runtime_error("zlib cannot deflate " + std::to_string(bytes.size()) + " bytes");
  }
  packed.resize(size);
  packed.shrink_to_fit();
  return packed;
}

/// Walks packed tiles; every read is checked.
class CellReader {
 public:
  CellReader(const std::string& packed, std::uint32_t raw_bytes) : bytes_(raw_bytes, '\0') {
    uLongf size = raw_bytes;
    sound_ = raw_bytes == 0
                 ? packed.empty()
                 : uncompress(reinterpret_cast<Bytef*>(bytes_.data()), &size,
                              reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK &&
                       size == raw_bytes;
  }

  bool sound() const { return sound_; }

  /// Calls `visit(corner, words)` for each tile of which `wants(corner)` is true, until it returns false.
  template <class Wants, class Visit>
  void visit(const Wants& wants, const Visit& visit) {
    std::array<std::uint64_t, ScanTile::words> words{};
    while (sound_ && at_ < bytes_.size()) {
      Eigen::Vector3i corner;
      for (int axis = 0; axis < 3; ++axis) corner[axis] = static_cast<std::int16_t>(get(2));
      const Codes codes = read_codes();
      if (!wants(corner)) {
        skip_words(codes);
        continue;
      }
      read_words(codes, words);
      if (sound_ && !visit(corner, words)) return;
    }
  }

 private:
  /// Goes on by `count` bytes; false, and no more to read, when there are not as many.
  bool skip(std::size_t count) {
    sound_ = sound_ && bytes_.size() - at_ >= count;
    at_ = sound_ ? at_ + count : bytes_.size();
    return sound_;
  }

  std::uint64_t get(std::size_t count) {
    const std::size_t from = at_;
    if (!skip(count)) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(bytes_[from + i])} << 8 * i;
    return value;
  }

  using Codes = std::array<unsigned, cubes>;

  Codes read_codes() {
    Codes codes{};
    for (std::size_t i = 0; i < cubes; i += 4) {
      const std::uint64_t four = get(1);
      for (std::size_t j = 0; j < 4; ++j) codes[i + j] = static_cast<unsigned>(four >> 2 * j & 3U);
    }
    return codes;
  }

  void skip_words(const Codes& codes) {
    constexpr std::uint64_t high_bits = 0xaaaaU;  // of a code: set for `some`
    for (const unsigned code : codes) {
      if (code != some) continue;
      const std::uint64_t of_words = get(2);
      skip(8 * static_cast<std::size_t>(std::popcount(of_words & high_bits & ~(of_words << 1U))));
    }
  }

  void read_words(const Codes& codes, std::array<std::uint64_t, ScanTile::words>& words) {
    for (std::size_t cube = 0; cube < cubes; ++cube) {
      const std::uint64_t of_words = codes[cube] == some ? get(2) : codes[cube] == every ? 0x5555U : 0U;
      for (std::size_t i = 0; i < words_per_cube; ++i) {
        const auto code = static_cast<unsigned>(of_words >> 2 * i & 3U);
        words[cube * words_per_cube + i] = code == some ? get(8) : code == every ? all : 0;
      }
    }
  }

  std::string bytes_;
  std::size_t at_ = 0;
  bool sound_ = true;
};

bool every_tile(const Eigen::Vector3i&) { return true; }

}  // namespace

TouchedCells::TouchedCells(const std::vector<ScanTile*>& tiles, Kind kind) {
  std::string bytes;
  for (const ScanTile* tile : tiles)
    pack_tile(tile->corner, kind == Kind::free ? tile->free : tile->occupied, bytes);
  complete_ = bytes.size() <= raw_limit;
  if (bytes.empty() || !complete_) return;
  raw_bytes_ = static_cast<std::uint32_t>(bytes.size());
  packed_ = deflated(bytes);
}

TouchedCells::TouchedCells(std::string packed, std::uint32_t raw_bytes)
    : packed_(std::move(packed)), raw_bytes_(raw_bytes) {}

bool TouchedCells::contains(const Eigen::Vector3i& cell) const {
  bool found = false;
  CellReader reader(packed_, raw_bytes_);
  const auto holds = [&](const Eigen::Vector3i& corner) {
    const Eigen::Array3i local = cell.array() - corner.array();
    return (local >= 0).all() && (local < ScanTile::edge).all();
  };
  reader.visit(holds, [&](const Eigen::Vector3i&, const auto& words) {
    const unsigned bit = ScanTile::bit_of(cell);
    found = (words[bit >> 6U] >> (bit & 63U) & 1U) != 0;
    return false;
  });
  return found;
}

std::size_t TouchedCells::count() const {
  std::size_t cells = 0;
  CellReader reader(packed_, raw_bytes_);
  reader.visit(every_tile, [&](const Eigen::Vector3i&, const auto& words) {
    for (const std::uint64_t word : words) cells += static_cast<std::size_t>(std::popcount(word));
    return true;
  });
  return cells;
}

bool TouchedCells::is_sound() const {
  CellReader reader(packed_, raw_bytes_);
  reader.visit(every_tile, [](const Eigen::Vector3i&, const auto&) { return true; });
  return reader.sound();
}

}  // namespace clearway
