#include "apps/inspect/slice_age.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/stamps/seen_stamps.hpp"

namespace clearway {
namespace {

/// Blues, which no other state has: fresh, in between, old.
constexpr std::array<AgeColours::Colour, 3> stops{{{222, 235, 247}, {107, 174, 214}, {8, 48, 107}}};

}  // namespace

AgeColours::AgeColours(const Snapshot& map) : newest_(0.0), greatest_age_(0.0) {
  if (map.seen() == nullptr)
    throw std::invalid_argument("--age: the map does not know when its voxels were seen");
  newest_ = map.seen()->newest();
  greatest_age_ = newest_ - map.seen()->oldest();
}

AgeColours::Colour AgeColours::of_age(double age) const {
  const double at = greatest_age_ > 0.0 ? 2.0 * std::clamp(age / greatest_age_, 0.0, 1.0) : 0.0;
  const auto below = static_cast<std::size_t>(std::min(std::floor(at), 1.0));
  const double share = at - static_cast<double>(below);
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i)
    colour[i] =
        static_cast<std::uint8_t>(std::lround((1.0 - share) * stops[below][i] + share * stops[below + 1][i]));
  return colour;
}

AgeColours::Colour AgeColours::of(std::optional<double> last_seen) const {
  return last_seen ? of_age(newest_ - *last_seen) : unknown;
}

}  // namespace clearway
