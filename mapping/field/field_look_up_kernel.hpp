#pragma once

#include "mapping/field/field_look_up.hpp"

// The look-ups for any width of registers. Included by the one file for each width, below its instruction
// set. Not through Highway as other loops: its gathers take offsets as wide as what they read, and these read
// 32 bits from addresses of 64.

namespace clearway {
namespace {

/// `Registers` has numbers (doubles), wholes (int) and addresses (64 bits), as many of each, with the four
/// operations that GCC's vectors lack: sqrt, and gathers of addresses, of 32 bits and of doubles.
template <class Registers>
class LookUp {
 public:
  using Numbers = typename Registers::Numbers;
  using Wholes = typename Registers::Wholes;
  using Addresses = typename Registers::Addresses;
  static constexpr std::size_t width = sizeof(Numbers) / sizeof(double);

  explicit LookUp(const FieldLookUp& field) : field_(field), roots_(half_roots()) {}

  void coarse(const FieldPoints& points, double* out) const {
    each(points, out, [this](const Place& place) {
      Wholes cell[3];
      Numbers gap[3];
#pragma GCC unroll 3
      for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = at_most(to_wholes(place.at[axis]), field_.last[axis]);
        gap[axis] = squared_gap(place.at[axis], cell[axis]);
      }
      const Wholes row = row_in_tile(cell[1], cell[2]) + (cell[0] & 30);
      const Wholes pair = read(cells_of(tile(cell[0], cell[1], cell[2]), place.missing), row);
      const Wholes squared = (cell[0] & 1) != 0 ? upper(pair) : pair & 0xffff;
      const Numbers best = bound(squared, gap[0] + gap[1] + gap[2]);
      return finish(place, best * field_.resolution);
    });
  }

  void tight(const FieldPoints& points, double* out) const {
    each(points, out, [this](const Place& place) {
      const Numbers bound = best_of_eight(place) * field_.resolution;
      const Numbers result = finish(place, bound);
      return bound < 1.5 * field_.resolution ? Numbers{} + left_out : result;
    });
  }

 private:
  struct Place {
    Numbers point[3], at[3];         ///< in metres, and in cells from the region's corner
    mutable Addresses missing = {};  ///< where a tile is not known yet
  };

  static Wholes to_wholes(const Numbers& numbers) { return __builtin_convertvector(numbers, Wholes); }
  static Numbers to_numbers(const Wholes& wholes) { return __builtin_convertvector(wholes, Numbers); }
  static Wholes at_most(const Wholes& wholes, int most) {
    const Wholes limit = Wholes{} + most;
    return wholes < limit ? wholes : limit;
  }
  static Wholes upper(const Wholes& pair) { return pair >> 16 & 0xffff; }
  static Numbers squared_gap(const Numbers& at, const Wholes& cell) {
    const Numbers gap = at - to_numbers(cell) - 0.5;
    return gap * gap;
  }

  Wholes tile(const Wholes& x, const Wholes& y, const Wholes& z) const {
    return ((z >> 3) * field_.tiles_y + (y >> 3)) * field_.tiles_x + (x >> 5);
  }
  /// Where tiles are not known yet, some cells stand for theirs.
  Addresses cells_of(const Wholes& tile, Addresses& missing) const {
    alignas(64) static const std::uint16_t some[2048] = {};
    const Addresses cells = Registers::gather_addresses(field_.tiles, tile);
    const auto is_missing = reinterpret_cast<Addresses>(cells == 0);
    missing |= is_missing;
    return is_missing != 0 ? Addresses{} + reinterpret_cast<std::intptr_t>(some) : cells;
  }
  static Wholes row_in_tile(const Wholes& y, const Wholes& z) { return ((z & 7) << 8) + ((y & 7) << 5); }

  /// A cell and the next one, which must lie in the same tile.
  static Wholes read(const Addresses& cells, const Wholes& cell) {
    return Registers::gather_pairs(cells + (__builtin_convertvector(cell, Addresses) << 1));
  }
  Numbers bound(const Wholes& squared, const Numbers& gap) const {
    return Registers::gather_numbers(roots_, squared) - Registers::sqrt(gap);
  }

  Numbers best_of_eight(const Place& place) const {
    const Numbers* const at = place.at;
    Wholes low[3], high[3];
    Numbers gap[3][2];
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const Numbers below = at[axis] - 0.5;
      low[axis] = at_most(to_wholes(below > 0.0 ? below : Numbers{}), field_.last[axis]);
      high[axis] = at_most(low[axis] + 1, field_.last[axis]);
      gap[axis][0] = squared_gap(at[axis], low[axis]);
      gap[axis][1] = squared_gap(at[axis], high[axis]);
    }
    const Wholes x = low[0] & 31;
    const Wholes last_of_tile = x == 31;
    const Wholes crosses = (low[0] >> 5) != (high[0] >> 5);
    const bool any_crosses = any(crosses);
    const Wholes start = x + last_of_tile;  // a true comparison is -1
    Numbers best{};
#pragma GCC unroll 4
    for (unsigned row = 0; row < 4; ++row) {
      const Wholes& y = row & 1U ? high[1] : low[1];
      const Wholes& z = row & 2U ? high[2] : low[2];
      const Wholes in_tile = row_in_tile(y, z);
      const Wholes pair = read(cells_of(tile(low[0], y, z), place.missing), in_tile + start);
      const Wholes here = last_of_tile ? upper(pair) : pair & 0xffff;
      Wholes next = high[0] == low[0] ? here : upper(pair);
      if (any_crosses) {
        next = crosses ? read(cells_of(tile(high[0], y, z), place.missing), in_tile) & 0xffff : next;
      }
      const Numbers& gap_y = gap[1][row & 1U];
      const Numbers& gap_z = gap[2][row >> 1U];
      best = larger(best, bound(here, gap[0][0] + gap_y + gap_z));
      best = larger(best, bound(next, gap[0][1] + gap_y + gap_z));
    }
    return best;
  }

  static bool any(const Wholes& truths) {
    int all = 0;
    for (std::size_t i = 0; i < width; ++i) all |= truths[i];
    return all != 0;
  }
  static Numbers larger(const Numbers& a, const Numbers& b) { return a > b ? a : b; }
  static Numbers smaller(const Numbers& a, const Numbers& b) { return a < b ? a : b; }

  Numbers finish(const Place& place, Numbers bound) const {
    Numbers largest{};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const Numbers& point = place.point[axis];
      largest = larger(largest, larger(point, -point));
      if (!field_.outside_blocked) continue;
      bound = smaller(bound, smaller(point - field_.low[axis], field_.high[axis] - point));
    }
    bound = bound - (rounding_of_voxel * field_.resolution + rounding_of_coordinate * largest);
    return smaller(larger(bound, Numbers{}), Numbers{} + field_.max_distance);
  }

  template <class Bound>
  void each(const FieldPoints& points, double* out, const Bound& bound) const {
    const double* const axes[3] = {points.x, points.y, points.z};
    std::size_t i = 0;
    for (; i + width <= points.count; i += width) {
      Place place;
      auto inside = ~Addresses{};
#pragma GCC unroll 3
      for (int axis = 0; axis < 3; ++axis) {
        place.point[axis] = Registers::load(axes[axis] + i);
        inside &= (place.point[axis] >= field_.low[axis]) & (place.point[axis] <= field_.high[axis]);
      }
#pragma GCC unroll 3
      for (int axis = 0; axis < 3; ++axis) {
        place.point[axis] = inside ? place.point[axis] : Numbers{} + field_.low[axis];
        place.at[axis] = place.point[axis] * field_.inverse_resolution - field_.first[axis];
      }
      const Numbers bounds = bound(place);
      Registers::store(out + i, (inside & ~place.missing) != 0 ? bounds : Numbers{} + left_out);
    }
    for (; i < points.count; ++i) out[i] = left_out;
  }

  const FieldLookUp field_;
  const double* roots_;
};

}  // namespace
}  // namespace clearway
