// Not part of the installed library. Included once for each instruction set, so there is no #pragma once.

#include "mapping/field/byte_field.hpp"
#include "planning/batch/sphere_robot.hpp"

#if defined(CLEARWAY_LANE_SIGHT) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_SIGHT
#undef CLEARWAY_LANE_SIGHT
#else
#define CLEARWAY_LANE_SIGHT
#endif

#include "planning/batch/lane_vectors.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

struct Sight {
  Vector lower;  ///< no blocked cube is nearer, metres
  Vector upper;  ///< some blocked cube is no farther, where that is known
};

/// A point in voxels from the field's corner, moved into the field.
struct Spot {
  Point inside;
  Vector border;  ///< how deep in the field the point itself is, voxels
  Vector beyond;  ///< more than 0 where it is not in it
};

HWY_INLINE Point sizes_of(const ByteField& bytes) {
  const auto size = [&](int i) HWY_ATTR { return all(static_cast<float>(bytes.size[i])); };
  return {size(0), size(1), size(2)};
}

HWY_INLINE Point clamped(const Point& at, const Point& sizes) {
  const auto axis = [](Vector value, Vector size)
                        HWY_ATTR { return hn::Min(hn::Max(value, hn::Zero(Tag())), size); };
  return {axis(at.x, sizes.x), axis(at.y, sizes.y), axis(at.z, sizes.z)};
}

HWY_INLINE Spot spot_of(const SphereRobot::Field& field, const Point& point) {
  const Vector scale = all(static_cast<float>(1.0 / field.bytes->resolution));
  const Point sizes = sizes_of(*field.bytes), low{all(field.low[0]), all(field.low[1]), all(field.low[2])};
  const Point offset = times(scale, minus(point, low));
  Spot spot{clamped(offset, sizes), all(1e30F), hn::Zero(Tag())};
  const auto axis = [&](Vector at, Vector inside, Vector size) HWY_ATTR {
    spot.border = hn::Min(spot.border, hn::Min(at, hn::Sub(size, at)));
    spot.beyond = hn::Add(spot.beyond, hn::Abs(hn::Sub(at, inside)));
  };
  axis(offset.x, spot.inside.x, sizes.x);
  axis(offset.y, spot.inside.y, sizes.y);
  axis(offset.z, spot.inside.z, sizes.z);
  return spot;
}

inline HWY_NOINLINE void know(const ByteField& bytes, Whole cell, Whole number) {
  std::int32_t cells[lane_count], numbers[lane_count];
  hn::StoreU(cell, WholeTag(), cells);
  hn::StoreU(number, WholeTag(), numbers);
  for (std::size_t i = 0; i < hn::Lanes(WholeTag()); ++i)
    if (numbers[i] == 0) bytes.know(static_cast<std::size_t>(cells[i]));
}

/// The numbers of cells; those that are not known yet are made.
HWY_INLINE Whole number_of(const ByteField& bytes, Whole cell) {
  const auto* first = reinterpret_cast<const std::int32_t*>(bytes.cells.data());
  const Whole byte = hn::Set(WholeTag(), 255);
  const Whole number = hn::And(hn::GatherOffset(WholeTag(), first, cell), byte);
  if (hn::AllFalse(WholeTag(), hn::Eq(number, hn::Zero(WholeTag())))) return number;
  know(bytes, cell, number);
  return hn::And(hn::GatherOffset(WholeTag(), first, cell), byte);
}

/// ByteField::index.
HWY_INLINE Whole index_of(const ByteField& bytes, Whole x, Whole y, Whole z) {
  const auto low_bits = [](Whole value, int bits)
                            HWY_ATTR { return hn::And(value, hn::Set(WholeTag(), bits)); };
  const auto times = [](Whole value, int factor)
                         HWY_ATTR { return hn::Mul(value, hn::Set(WholeTag(), factor)); };
  const Whole row = hn::Add(times(hn::ShiftRight<3>(z), bytes.tiles[1]), hn::ShiftRight<3>(y));
  const Whole tile = hn::Add(times(row, bytes.tiles[0]), hn::ShiftRight<5>(x));
  const Whole in_slice = hn::Or(hn::ShiftLeft<5>(low_bits(y, 7)), low_bits(x, 31));
  const Whole in_tile = hn::Or(hn::ShiftLeft<8>(low_bits(z, 7)), in_slice);
  return hn::Or(hn::ShiftLeft<11>(tile), in_tile);
}

/// How many steps of distance the cell that holds a point of the field has, and where that cell's middle is.
HWY_INLINE Vector units_at(const ByteField& bytes, const Point& inside, Point& middle) {
  const auto axis = [&](Vector at, int i, Vector& to) HWY_ATTR {
    const auto cell = hn::Min(hn::ConvertTo(WholeTag(), at), hn::Set(WholeTag(), bytes.size[i] - 1));
    to = hn::Add(hn::ConvertTo(Tag(), cell), all(0.5F));
    return cell;
  };
  const auto x = axis(inside.x, 0, middle.x);
  const auto y = axis(inside.y, 1, middle.y);
  const auto z = axis(inside.z, 2, middle.z);
  return hn::Sub(hn::ConvertTo(Tag(), number_of(bytes, index_of(bytes, x, y, z))), all(1.0F));
}

/// What one cell says of a point: its distance, less and more by how far the point is from its middle.
HWY_INLINE Sight sight_from(const ByteField& bytes, const Spot& spot, Vector units, const Point& middle) {
  const Vector resolution = all(static_cast<float>(bytes.resolution));
  const Vector off = hn::Mul(hn::Sqrt(squared(minus(spot.inside, middle))), resolution);
  const Vector step = all(static_cast<float>(bytes.step));
  Sight seen;
  seen.lower = hn::Sub(hn::Mul(units, step), off);
  if (bytes.outside_blocked) seen.lower = hn::Min(seen.lower, hn::Mul(spot.border, resolution));
  const Vector most = hn::Add(hn::Mul(hn::Add(units, all(1.0F)), step), off);
  const Mask unknown =
      hn::Or(hn::Ge(units, all(static_cast<float>(bytes.end - 1))), hn::Gt(spot.beyond, hn::Zero(Tag())));
  seen.upper = hn::IfThenElse(unknown, all(1e30F), hn::IfThenZeroElse(hn::Eq(units, hn::Zero(Tag())), most));
  return seen;
}

/// By the cell that holds the point.
HWY_INLINE Sight sight(const SphereRobot::Field& field, const Point& point) {
  const Spot spot = spot_of(field, point);
  Point middle;
  const Vector units = units_at(*field.bytes, spot.inside, middle);
  return sight_from(*field.bytes, spot, units, middle);
}

/// Away from what is near, by the numbers of the cells on both sides along each axis; zero where they are the
/// same.
HWY_INLINE Point way_out(const ByteField& bytes, const Point& middle, const Point& sizes) {
  const auto units = [&](float x, float y, float z) HWY_ATTR {
    Point ignored;
    return units_at(bytes, clamped(plus(middle, {all(x), all(y), all(z)}), sizes), ignored);
  };
  const Point way{hn::Sub(units(1, 0, 0), units(-1, 0, 0)), hn::Sub(units(0, 1, 0), units(0, -1, 0)),
                  hn::Sub(units(0, 0, 1), units(0, 0, -1))};
  return times(hn::Div(all(1.0F), hn::Max(hn::Sqrt(squared(way)), all(1e-3F))), way);
}

/// The same, closer: a cell farther out on the line from what is near through the point loses less by how far
/// it is from the point, for that is nearly all on this line; and the cube that is near is looked at itself.
HWY_INLINE Sight close_sight(const SphereRobot::Field& field, const Point& point) {
  const ByteField& bytes = *field.bytes;
  const Point sizes = sizes_of(bytes);
  const Spot spot = spot_of(field, point);
  Point middle;
  Sight seen = sight_from(bytes, spot, units_at(bytes, spot.inside, middle), middle);
  const Point out = way_out(bytes, middle, sizes);
  for (const float voxels : {1.5F, 3.0F}) {
    const Vector units = units_at(bytes, clamped(plus(spot.inside, times(all(voxels), out)), sizes), middle);
    seen.lower = hn::Max(seen.lower, sight_from(bytes, spot, units, middle).lower);
  }
  const Vector resolution = all(static_cast<float>(bytes.resolution));
  const Vector way = hn::Add(hn::Max(hn::Div(seen.lower, resolution), hn::Zero(Tag())), all(0.5F));
  const Vector units = units_at(bytes, clamped(minus(spot.inside, times(way, out)), sizes), middle);
  const Point gap = minus(spot.inside, middle);
  const auto past = [&](Vector from)
                        HWY_ATTR { return hn::Max(hn::Sub(hn::Abs(from), all(0.5F)), hn::Zero(Tag())); };
  const Vector to_cube = hn::Mul(hn::Sqrt(squared({past(gap.x), past(gap.y), past(gap.z)})), resolution);
  const Mask known = hn::And(hn::Eq(units, hn::Zero(Tag())), hn::Le(spot.beyond, hn::Zero(Tag())));
  seen.upper = hn::IfThenElse(known, hn::Min(seen.upper, to_cube), seen.upper);
  return seen;
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
