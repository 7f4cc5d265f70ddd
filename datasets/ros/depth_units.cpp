#include "datasets/ros/depth_units.hpp"

#include <algorithm>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// The topic of the sensor's options; empty: the topic is none of that SDK's.
std::string options_beside(const std::string& depth) {
  const std::string end = "/image/data";
  if (!depth.starts_with("/device_") || !depth.ends_with(end)) return "";
  const std::size_t stream = depth.rfind('/', depth.size() - end.size() - 1);
  return depth.substr(0, stream) + "/option/";
}

}  // namespace

bool is_depth_units(const BagTopic& topic, const std::string& depth) {
  const std::string options = options_beside(depth);
  if (options.empty() || topic.type != "std_msgs/Float32") return false;
  std::string name = topic.name;
  std::replace(name.begin(), name.end(), '_', ' ');
  std::string wanted = options + "Depth Units/value";
  std::replace(wanted.begin(), wanted.end(), '_', ' ');
  return name == wanted;
}

double read_depth_units(WireReader& in) {
  const double step = in.number<float>();
  if (!(step >= 1e-7 && step <= 10.0))
    throw std::runtime_error("its steps of depth are " + short_text(step) + " m, expected 1e-7 to 10");
  return step;
}

}  // namespace clearway
