#include "datasets/ros/sensor_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>

#include "datasets/cameras/packed_pixels.hpp"
#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

PackedPixels packed_pixels(const RosImage& image) {
  return {image.encoding, image.width, image.height, image.step, image.is_bigendian, image.data};
}

/// A number of the message, whatever its byte order.
template <class Number>
Number number_at(std::span<const std::uint8_t> data, std::size_t at, bool is_bigendian) {
  std::uint8_t bytes[sizeof(Number)];
  std::copy_n(&data[at], sizeof(Number), bytes);
  if (is_bigendian) std::reverse(std::begin(bytes), std::end(bytes));
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Metres at a pixel of a depth image; 0: no return.
double depth_at(const RosImage& image, std::size_t at, bool is_float, double step) {
  if (is_float) {
    const double depth = number_at<float>(image.data, at, image.is_bigendian);
    return std::isfinite(depth) && depth > 0.0 ? depth : 0.0;
  }
  const auto steps = number_at<std::uint16_t>(image.data, at, image.is_bigendian);
  return steps < saturated_depth ? step * steps : 0.0;
}

void require_points(const RosPointCloud& cloud) {
  const bool is_one_row = cloud.height == 1 && cloud.row_step == 0;  // some leave it unset
  if (is_one_row
          ? cloud.data.size() / std::max(cloud.point_step, 1U) < cloud.width
          : cloud.width > 0 && (cloud.row_step / cloud.width < cloud.point_step ||
                                (cloud.row_step > 0 && cloud.data.size() / cloud.row_step < cloud.height)))
    throw std::runtime_error("its data is shorter than its size says");
}

/// Bytes of a number of PointField; 0 for a kind that there is not.
std::size_t size_of(std::uint8_t datatype) {
  constexpr std::array<std::size_t, 9> sizes{0, 1, 1, 2, 2, 4, 4, 4, 8};
  return datatype < sizes.size() ? sizes[datatype] : 0;
}

double number_of(const RosPointCloud& cloud, std::size_t at, std::uint8_t datatype) {
  const auto number = [&](auto kind) {
    return static_cast<double>(number_at<decltype(kind)>(cloud.data, at, cloud.is_bigendian));
  };
  switch (datatype) {
    case 1:
      return number(std::int8_t{});
    case 2:
      return number(std::uint8_t{});
    case 3:
      return number(std::int16_t{});
    case 4:
      return number(std::uint16_t{});
    case 5:
      return number(std::int32_t{});
    case 6:
      return number(std::uint32_t{});
    case 7:
      return number(float{});
    default:
      return number(double{});
  }
}

const RosPointField& field_of(const RosPointCloud& cloud, const std::string& name) {
  const auto found = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                  [&](const RosPointField& field) { return field.name == name; });
  constexpr std::uint8_t float32 = 7, float64 = 8;
  if (found == cloud.fields.end() || (found->datatype != float32 && found->datatype != float64))
    throw std::runtime_error("it has no field " + quote(name) + " of floats");
  if (found->offset > cloud.point_step ||
      cloud.point_step - found->offset < (found->datatype == float32 ? 4U : 8U))
    throw std::runtime_error("its field " + quote(name) + " lies beyond its points");
  return *found;
}

}  // namespace

GrayImage gray_image(const RosImage& image) { return gray_pixels(packed_pixels(image)); }

GrayImage gray_image(const RosCompressedImage& image) {
  return decode_picture(std::string(reinterpret_cast<const char*>(image.data.data()), image.data.size()));
}

CloudFrame depth_cloud(const RosImage& image, const CameraIntrinsics& camera,
                       const std::vector<Eigen::Vector2d>& rays, double step) {
  const bool is_float = image.encoding == "32FC1";
  if (!is_float && image.encoding != "16UC1" && image.encoding != "mono16")
    throw std::runtime_error("its encoding " + quote(image.encoding) +
                             " is no depth, expected 16UC1 or 32FC1");
  const std::size_t size = is_float ? 4 : 2;
  require_rows(packed_pixels(image), size);
  if (static_cast<int>(image.width) != camera.width || static_cast<int>(image.height) != camera.height)
    throw std::runtime_error("it has another size than its camera");
  CloudFrame cloud;
  cloud.kind = "depth";
  for (std::size_t row = 0; row < image.height; ++row) {
    for (std::size_t column = 0; column < image.width; ++column) {
      const double depth = depth_at(image, row * image.step + column * size, is_float, step);
      const Eigen::Vector2d& ray = rays[row * image.width + column];
      if (depth == 0.0 || !ray.allFinite()) continue;
      cloud.points.emplace_back(static_cast<float>(depth), static_cast<float>(-depth * ray.x()),
                                static_cast<float>(-depth * ray.y()));
    }
  }
  return cloud;
}

namespace {

/// Calls `take` with where each point begins in the data.
template <class Take>
void for_each_point(const RosPointCloud& cloud, const Take& take) {
  require_points(cloud);
  for (std::size_t row = 0; row < cloud.height; ++row)
    for (std::size_t column = 0; column < cloud.width; ++column)
      take(row * cloud.row_step + column * cloud.point_step);
}

/// Reads places.
class PlaceReader {
 public:
  explicit PlaceReader(const RosPointCloud& cloud)
      : cloud_(cloud), fields_{&field_of(cloud, "x"), &field_of(cloud, "y"), &field_of(cloud, "z")} {}
  Eigen::Vector3f at(std::size_t begin) const {
    Eigen::Vector3f point;
    for (int axis = 0; axis < 3; ++axis) {
      const RosPointField& field = *fields_[static_cast<std::size_t>(axis)];
      point[axis] = static_cast<float>(number_of(cloud_, begin + field.offset, field.datatype));
    }
    return point;
  }

 private:
  const RosPointCloud& cloud_;
  std::array<const RosPointField*, 3> fields_;
};

/// s of one step of times that span so much, as a sweep of a sensor does. Ouster's `t` and Livox's
/// `offset_time` are ns, of however small a part of a sweep.
double unit_of(const RosPointField& field, double span, double last) {
  const bool is_integer = field.datatype < 7;
  if (is_integer && (field.name == "t" || field.name == "offset_time")) return 1e-9;
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
    if (unit * span >= 0.01 && unit * span <= 0.5) return unit;
  return is_integer || std::abs(last) >= 1e15 ? 1e-9 : 1.0;
}

}  // namespace

std::optional<PointTimes> point_times(const RosPointCloud& cloud) {
  const auto is_time = [&](const RosPointField& field) {
    constexpr std::array names{"t", "time", "timestamp", "time_stamp", "offset_time", "time_offset"};
    return std::find(names.begin(), names.end(), field.name) != names.end() && size_of(field.datatype) > 0 &&
           field.offset <= cloud.point_step && cloud.point_step - field.offset >= size_of(field.datatype);
  };
  const auto field = std::find_if(cloud.fields.begin(), cloud.fields.end(), is_time);
  if (field == cloud.fields.end()) return std::nullopt;
  const PlaceReader places(cloud);
  PointTimes out{field->name, 0.0, {}};
  for_each_point(cloud, [&](std::size_t begin) {
    const Eigen::Vector3f point = places.at(begin);
    if (point.allFinite() && !point.isZero(0.0F))
      out.times.push_back(number_of(cloud, begin + field->offset, field->datatype));
  });
  if (out.times.empty()) return std::nullopt;
  const bool are_finite =
      std::all_of(out.times.begin(), out.times.end(), [](double time) { return std::isfinite(time); });
  const auto [first, last] = std::minmax_element(out.times.begin(), out.times.end());
  out.raw_span = are_finite ? *last - *first : HUGE_VAL;
  if (out.raw_span == 0.0) return std::nullopt;
  constexpr double longest = 10.0;  // s
  const double unit = unit_of(*field, out.raw_span, *last);
  const double from = std::abs(unit * *first) > longest ? cloud.header.time : 0.0;
  const double since = unit * *first - from, until = unit * *last - from;
  const bool is_sound = are_finite && until - since <= longest && std::abs(since) <= longest;
  if (!is_sound) {
    out.times.clear();
    return out;
  }
  for (double& time : out.times) time = unit * time - from;
  return out;
}

bool has_other_order(RosPointCloud cloud) {
  constexpr std::size_t most = 1000;
  const std::size_t count = std::size_t{cloud.height} * cloud.width,
                    stride = std::max<std::size_t>(count / most, 1);
  std::size_t numbers = 0;  // but those that are 0 or NaN, as of what did not come back
  const auto sound_ones = [&](bool is_bigendian) {
    cloud.is_bigendian = is_bigendian;
    const PlaceReader places(cloud);
    std::size_t at = 0, sound = 0;
    numbers = 0;
    for_each_point(cloud, [&](std::size_t begin) {
      if (at++ % stride != 0) return;
      for (const float number : places.at(begin)) {
        numbers += number != 0.0F && !std::isnan(number);
        sound += std::abs(number) >= 1e-4F && std::abs(number) <= 1e4F;
      }
    });
    return sound;
  };
  const bool stated = cloud.is_bigendian;
  const std::size_t as_stated = sound_ones(stated), otherwise = sound_ones(!stated);
  return 2 * as_stated < otherwise && 2 * otherwise > numbers;
}

CloudFrame points_cloud(const RosPointCloud& cloud) {
  const PlaceReader places(cloud);
  CloudFrame out;
  out.kind = "points";
  for_each_point(cloud, [&](std::size_t begin) { take_point(out, places.at(begin)); });
  return out;
}

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

bool has_range(const RosLaserScan& scan) { return std::isfinite(scan.range_max) && scan.range_max > 0.0F; }

/// +inf (REP 117), or no less than range_max, which many drivers write where nothing came back.
bool met_nothing(const RosLaserScan& scan, float range) {
  return range > 0.0F && (std::isinf(range) || (has_range(scan) && range >= scan.range_max));
}

/// @throws std::runtime_error a clause, where the beams can be nowhere
void require_beams(const RosLaserScan& scan) {
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment))
    throw std::runtime_error("its angles are not finite");
  if (!(scan.range_max > 0.0F))
    throw std::runtime_error("its range_max is " + short_text(scan.range_max) +
                             ", expected metres, more than 0");
  const double beams = static_cast<double>(scan.ranges.size()), step = std::abs(double{scan.angle_increment});
  if (beams > 1.0 && step == 0.0) throw std::runtime_error("its angle_increment is 0, expected radians");
  if (step * (beams - 1.0) > 1.5 * turn || (beams > 1.0 && step > turn))
    throw std::runtime_error("its beams span " + short_text(step * (beams - 1.0)) +
                             " rad, expected a turn at most; are its angles degrees?");
}

}  // namespace

bool has_opposite_angles(const RosLaserScan& scan) {
  const double step = scan.angle_increment, way = double{scan.angle_max} - double{scan.angle_min};
  if (step == 0.0 || std::abs(way) <= std::abs(step) || (way > 0.0) == (step > 0.0)) return false;
  // Of a window across the back of the sensor, the beams are what is left of a turn.
  const double span = std::abs(step) * (static_cast<double>(scan.ranges.size()) - 1.0);
  return std::abs(span + std::abs(way) - turn) > 2.0 * std::abs(step) + 0.02;
}

std::vector<LaserReturn> laser_returns(const RosLaserScan& scan, bool with_clear) {
  require_beams(scan);
  std::vector<LaserReturn> returns;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const bool is_nothing = met_nothing(scan, scan.ranges[i]);
    const bool is_clear = with_clear && is_nothing && has_range(scan);
    const double range = is_clear ? double{scan.range_max} : double{scan.ranges[i]};
    const double angle = double{scan.angle_min} + static_cast<double>(i) * double{scan.angle_increment};
    const bool is_return = std::isfinite(range) && range > 0.0 && range >= double{scan.range_min} &&
                           range <= double{scan.range_max};
    if (is_return && (is_clear || !is_nothing))
      returns.push_back(
          {i,
           {static_cast<float>(range * std::cos(angle)), static_cast<float>(range * std::sin(angle)), 0.0F},
           is_clear});
  }
  return returns;
}

CloudFrame empty_laser_cloud(const RosLaserScan& scan) {
  CloudFrame cloud;
  cloud.kind = "laser2d";
  if (has_range(scan)) cloud.max_range = double{scan.range_max};
  for (const float range : scan.ranges) {
    cloud.infinite += met_nothing(scan, range) ? 1 : 0;
    cloud.at_range += met_nothing(scan, range) && std::isfinite(range) ? 1 : 0;
  }
  return cloud;
}

CloudFrame laser_cloud(const RosLaserScan& scan, bool with_clear) {
  CloudFrame cloud = empty_laser_cloud(scan);
  const double sweep = double{scan.time_increment} * static_cast<double>(scan.ranges.size());
  const bool is_timed = sweep != 0.0 && std::abs(sweep) <= longest_sweep;
  for (const LaserReturn& one : laser_returns(scan, with_clear)) {
    (one.is_clear ? cloud.clear_to : cloud.points).push_back(one.point);
    if (is_timed && !one.is_clear) cloud.times.push_back(scan.time_increment * static_cast<float>(one.ray));
  }
  return cloud;
}

}  // namespace clearway
