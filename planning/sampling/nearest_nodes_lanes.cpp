#include "mapping/system/highway_targets.hpp"
#include "planning/sampling/nearest_nodes.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/sampling/nearest_nodes_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// Of `eights` times eight points; `rows` holds eight numbers for each of their coordinates.
std::size_t find_nearest(const double* rows, std::size_t eights, const double* to, std::size_t dimensions) {
  namespace hn = hwy::HWY_NAMESPACE;
  using Tag = hn::CappedTag<double, 8>;
  const Tag tag;
  const hn::RebindToSigned<Tag> whole;
  constexpr std::size_t width = hn::MaxLanes(Tag()), parts = 8 / width;
  hn::Vec<Tag> nearest[parts];
  hn::Vec<hn::RebindToSigned<Tag>> places[parts];
  for (std::size_t part = 0; part < parts; ++part) {
    nearest[part] = hn::Set(tag, std::numeric_limits<double>::infinity());
    places[part] = hn::Zero(whole);
  }
  const double* row = rows;
  for (std::size_t eight = 0; eight < eights; ++eight) {
    hn::Vec<Tag> sum[parts];
    for (auto& part : sum) part = hn::Zero(tag);
    for (std::size_t i = 0; i < dimensions; ++i, row += 8) {
      const auto at = hn::Set(tag, to[i]);
      for (std::size_t part = 0; part < parts; ++part) {
        const auto apart = hn::Sub(hn::Load(tag, row + part * width), at);
        sum[part] = hn::Add(sum[part], hn::Mul(apart, apart));
      }
    }
    const auto place = hn::Set(whole, static_cast<std::int64_t>(eight));
    for (std::size_t part = 0; part < parts; ++part) {
      const auto is_nearer = hn::Lt(sum[part], nearest[part]);
      nearest[part] = hn::IfThenElse(is_nearer, sum[part], nearest[part]);
      places[part] = hn::IfThenElse(hn::RebindMask(whole, is_nearer), place, places[part]);
    }
  }
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    HWY_ALIGN double distances[8];
    HWY_ALIGN std::int64_t eight_of[8];
    hn::Store(nearest[part], tag, distances);
    hn::Store(places[part], whole, eight_of);
    for (std::size_t lane = 0; lane < width; ++lane) {
      const std::size_t place = static_cast<std::size_t>(eight_of[lane]) * 8 + part * width + lane;
      if (distances[lane] < least || (distances[lane] == least && place < best))
        least = distances[lane], best = place;
    }
  }
  return best;
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

void NearestNodes::add(const Eigen::VectorXd& point) {
  const std::size_t place = size_++ % 8;
  if (place == 0) {
    Eight none;
    for (double& number : none.at) number = std::numeric_limits<double>::infinity();
    rows_.resize(rows_.size() + dimensions_, none);
  }
  Eight* const rows = rows_.data() + (rows_.size() - dimensions_);
  for (std::size_t i = 0; i < dimensions_; ++i) rows[i].at[place] = point[static_cast<Eigen::Index>(i)];
}

std::size_t NearestNodes::nearest(const Eigen::VectorXd& to) const {
  static const InstructionSet widest = best_instruction_set();
  return nearest(to, widest);
}

std::size_t NearestNodes::nearest(const Eigen::VectorXd& to, [[maybe_unused]] InstructionSet vectors) const {
  const double* rows = rows_.front().at;
  const std::size_t eights = rows_.size() / dimensions_;
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::find_nearest(rows, eights, to.data(), dimensions_);
  if (vectors == InstructionSet::avx2) return N_AVX2::find_nearest(rows, eights, to.data(), dimensions_);
#endif
  return HWY_STATIC_DISPATCH(find_nearest)(rows, eights, to.data(), dimensions_);
}

}  // namespace clearway
#endif
