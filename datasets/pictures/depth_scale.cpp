#include "datasets/pictures/depth_scale.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>

#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr double scale_of_tum = 0.0002;  ///< m per step

/// Some of the depth in some pictures, spread over all, as it is stored.
struct DepthSample {
  std::vector<float> values;
  std::size_t pictures = 0;
};

DepthSample sample_of(const DepthLayout& layout) {
  constexpr std::size_t most = 7, stride = 61;
  const std::vector<fs::path> all = in_order_of_names(layout.depth);
  std::vector<fs::path> some;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    some.push_back(all[i * all.size() / std::min(most, all.size())]);
  FilesInChild pictures(some, "depth picture", [](const std::string& bytes, std::size_t) {
    const DepthPicture depth = decode_depth_picture(bytes);
    CloudFrame values;
    for (std::size_t i = 0; i < depth.values.size(); i += stride)
      if (depth.values[i] != 0.0F) values.points.emplace_back(depth.values[i], 0.0F, 0.0F);
    return values;
  });
  DepthSample sample{{}, some.size()};
  while (const auto picture = pictures.next()) {
    if (!picture->content) continue;  // told when it is read
    for (const Eigen::Vector3f& value : std::get<CloudFrame>(*picture->content).points)
      sample.values.push_back(value.x());
  }
  return sample;
}

}  // namespace

float DepthNumbers::value_of(float stored) const {
  if (!is_rotated) return stored;
  const auto bits = static_cast<std::uint16_t>(stored);
  return static_cast<float>(std::rotr(bits, 3));
}

bool are_steps_rotated(const DepthLayout& layout) {
  if (std::any_of(layout.depth.begin(), layout.depth.end(), is_depth_array)) return false;
  const DepthSample sample = sample_of(layout);
  std::size_t of_8 = 0, of_16 = 0;
  for (const float value : sample.values) {
    of_8 += std::fmod(value, 8.0F) <= 1.0F;  // beyond 8191 mm the last bit is set
    of_16 += std::fmod(value, 16.0F) <= 1.0F;
  }
  constexpr std::size_t least_kinds = 16;  // a wall straight ahead says nothing
  const std::size_t count = sample.values.size(),
                    kinds = std::set<float>(sample.values.begin(), sample.values.end()).size();
  return kinds >= least_kinds && 100 * of_8 >= 95 * count && 100 * of_16 <= 80 * count;
}

std::string why_of_tum(const DepthLayout& layout, const SourceOptions& options) {
  if (is_of_tum(options.depth.poses.empty() ? layout.poses : options.depth.poses))
    return "the files are TUM's";
  if (layout.tum_table.empty()) return "";
  return "TUM's, ETH3D's and ICL-NUIM's, whose tables of pictures are as " +
         quote_path(layout.tum_table.string());
}

SourceOptions with_scale(SourceOptions options, const std::string& why_of_tum, bool is_real) {
  if (!options.depth.scale)
    options.depth.scale = is_real ? 1.0 : why_of_tum.empty() ? usual_depth_scale : scale_of_tum;
  return options;
}

namespace {

/// "hardly a pixel of 7 pictures reaches …", where that is so; else empty.
std::string are_all_near(const DepthLayout& layout) {
  constexpr float far = 10000.0F;
  const DepthSample sample = sample_of(layout);
  const auto far_ones = static_cast<std::size_t>(
      std::count_if(sample.values.begin(), sample.values.end(), [](float step) { return step >= far; }));
  if (sample.values.empty() || far_ones * 1000 >= sample.values.size()) return "";
  return "hardly a pixel of " + counted(sample.pictures, "picture") +
         " reaches 10000 steps, as of others in millimetres";
}

}  // namespace

void require_steps_of_tum(const std::string& name, const DepthLayout& layout) {
  const std::string near = are_all_near(layout);
  if (near.empty()) return;
  throw std::invalid_argument(name + " has a table of depth pictures as TUM's, " +
                              quote_path(layout.tum_table.string()) + ", whose steps are 0.0002 m, but " +
                              near +
                              ": expected `source: {depth: {scale: …}}` in the setup, 0.0002 or 0.001");
}

std::string doubt_of_tum(const DepthLayout& layout) {
  const std::string near = are_all_near(layout);
  return near.empty() ? ""
                      : near +
                            ", of which the map would be a fifth of its size: `source: {depth: {scale: "
                            "0.001}}` states them, 0.0002 TUM's.";
}

void require_metres(const std::string& name, const DepthLayout& layout) {
  constexpr float far = 100.0F, background = 1e6F;
  std::vector<float> values = sample_of(layout).values;
  std::erase_if(values, [](float value) { return value >= background; });
  if (values.empty()) return;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (*middle <= far) return;
  throw std::invalid_argument(
      name + " has depth pictures of real numbers, half of them beyond " +
      std::to_string(std::lround(*middle)) +
      ", which are hardly metres: expected `source: {depth: {scale: …}}` in the setup, "
      "0.001 for millimetres, 1 for metres");
}

}  // namespace clearway
