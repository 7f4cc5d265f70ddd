#include "datasets/cameras/sensor_info.hpp"

#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/sources/finite_number.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr const char* depth_matrix = "m_calibrationDepthIntrinsic";

class InfoLines {
 public:
  InfoLines(const std::string& text, std::string name) : name_(std::move(name)) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string key, equals;
      if (!(words >> key >> equals) || equals != "=") continue;
      std::vector<std::string>& values = values_[key];
      values.clear();
      for (std::string word; words >> word;) values.push_back(word);
    }
  }

  double number(const std::string& key, double least, double most) const {
    const std::vector<double> all = numbers(key, 1);
    if (all[0] < least || all[0] > most)
      fail(key, "a number from " + short_text(least) + " to " + short_text(most));
    return all[0];
  }

  CameraIntrinsics camera(const std::string& kind, const std::string& matrix) const {
    constexpr double most = 1e6;
    const std::vector<double> k = numbers(matrix, 16);
    const auto is_size = [](double value) { return std::abs(value) <= most; };
    if (!(k[0] > 0.0 && k[5] > 0.0 && is_size(k[0]) && is_size(k[2]) && is_size(k[5]) && is_size(k[6])) ||
        k[1] != 0.0 || k[4] != 0.0)
      fail(matrix, "a camera's matrix, fx 0 cx 0  0 fy cy 0  0 0 1 0  0 0 0 1");
    const auto side = [&](const char* which) {
      return static_cast<int>(number("m_" + kind + which, 1, 65535));
    };
    return {side("Width"), side("Height"), k[0], k[5], k[2], k[6], {}};
  }

 private:
  std::vector<double> numbers(const std::string& key, std::size_t count) const {
    std::vector<double> all;
    if (const auto found = values_.find(key); found != values_.end()) {
      for (const std::string& word : found->second)
        if (const auto value = finite_number(word)) all.push_back(*value);
      if (all.size() != found->second.size()) all.clear();
    }
    if (all.size() != count) fail(key, count == 1 ? "a number" : std::to_string(count) + " numbers");
    return all;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& expected) const {
    throw std::invalid_argument(name_ + ": field '" + key + "': expected " + expected + " after '='");
  }

  std::string name_;
  std::map<std::string, std::vector<std::string>> values_;
};

}  // namespace

bool is_sensor_info(const std::string& text) {
  return text.starts_with("m_") && text.find(std::string("\n") + depth_matrix) != std::string::npos;
}

SensorInfo parse_sensor_info(const std::string& text, const std::string& name) {
  const InfoLines lines(text, name);
  return {lines.camera("depth", depth_matrix), lines.camera("color", "m_calibrationColorIntrinsic"),
          lines.number("m_depthShift", 1.0, 1e7)};
}

}  // namespace clearway
