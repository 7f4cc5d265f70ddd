#include "datasets/sources/scan_graph.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/inflating_stream.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// What a graph does not hold as it should; a clause.
struct DamagedGraph : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Points of a scan that fit into 128 MB and 20 times the file while a list of them grows.
std::size_t most_points(std::size_t file_bytes) { return ((128U << 20U) + 20 * file_bytes) / 40; }

constexpr std::size_t longest_line = 4096;

/// The nodes of a graph, one after the other.
class GraphNodes {
 public:
  virtual ~GraphNodes() = default;
  /// Points in the frame that they are stored in. False: there is no other node. @throws DamagedGraph
  virtual bool next(CloudFrame& node) = 0;
  virtual std::vector<std::string> warnings() const { return {}; }
};

/// As ScanGraph::writeBinary writes it: little-endian, and vectors and quaternions with their length.
class BinaryNodes final : public GraphNodes {
 public:
  BinaryNodes(InflatingStream& stream, std::size_t most_points)
      : stream_(stream), most_points_(most_points) {}

  bool next(CloudFrame& node) override {
    if (read_ == 0) nodes_ = number();
    if (read_ == nodes_) return false;
    ++read_;
    const std::uint32_t points = number();
    if (points > most_points_) fail("has more points than a scan has, " + std::to_string(points));
    for (std::uint32_t i = 0; i < points; ++i) take_point(node, numbers<3>().cast<float>());
    node.world_from_sensor.translation() = numbers<3>();
    const Eigen::Vector4d turn = numbers<4>();  // u, x, y, z
    if (!node.world_from_sensor.translation().allFinite() || !(std::abs(turn.norm() - 1.0) < 1e-3))
      fail("has no pose: expected a place and a unit quaternion");
    node.world_from_sensor.linear() =
        Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).normalized().toRotationMatrix();
    number();  // its id, for edges
    return true;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw DamagedGraph("node " + std::to_string(read_) + " of " + std::to_string(nodes_) + " " + why);
  }

  void fill(void* target, std::size_t size) {
    if (stream_.Read(target, size) != size) fail("is cut off");
  }

  std::uint32_t number() {
    std::array<std::uint8_t, 4> bytes{};
    fill(bytes.data(), bytes.size());
    return bytes[0] | bytes[1] << 8U | bytes[2] << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U;
  }

  template <int size>
  Eigen::Matrix<double, size, 1> numbers() {
    if (number() != size) fail("is no node of OctoMap's: vectors do not begin with their length");
    Eigen::Matrix<double, size, 1> values;
    fill(values.data(), sizeof(values));
    return values;
  }

  InflatingStream& stream_;
  std::size_t most_points_;
  std::uint32_t nodes_ = 0, read_ = 0;
};

/// Lines of a text.
class StreamLines {
 public:
  explicit StreamLines(InflatingStream& stream) : stream_(stream) {}

  /// False at the end. @throws DamagedGraph
  bool next(std::string& line) {
    line.clear();
    for (;;) {
      if (at_ == size_) {
        size_ = stream_.Read(buffer_.data(), buffer_.size());
        at_ = 0;
        if (size_ == 0 && line.empty()) return false;
      }
      const char* const from = buffer_.data() + at_;
      const void* const end = size_ > at_ ? std::memchr(from, '\n', size_ - at_) : nullptr;
      const std::size_t length =
          end ? static_cast<std::size_t>(static_cast<const char*>(end) - from) : size_ - at_;
      line.append(from, length);
      if (line.size() > longest_line)
        throw DamagedGraph("line " + std::to_string(number_ + 1) + " is no text");
      at_ += length + (end ? 1 : 0);
      if (!end && size_ > 0) continue;
      ++number_;
      if (line.ends_with('\r')) line.pop_back();
      return true;
    }
  }
  std::size_t number() const { return number_; }  ///< of the last one, from 1

 private:
  InflatingStream& stream_;
  std::array<char, 1 << 16> buffer_{};
  std::size_t at_ = 0, size_ = 0, number_ = 0;
};

/// OctoMap passes over lines that begin with a blank, too.
bool is_passed_over(const std::string& line) { return line.empty() || line[0] == '#' || line[0] == ' '; }

/// Lines "NODE x y z roll pitch yaw" and "x y z".
class TextNodes final : public GraphNodes {
 public:
  TextNodes(InflatingStream& stream, std::size_t most_points) : lines_(stream), most_points_(most_points) {}

  bool next(CloudFrame& node) override {
    while (!has_pose_) {
      if (!lines_.next(line_)) return false;
      if (!is_passed_over(line_)) take_pose();
    }
    node.world_from_sensor = pose_;
    has_pose_ = false;
    while (lines_.next(line_)) {
      if (is_passed_over(line_)) continue;
      if (line_.starts_with("NODE")) {
        take_pose();
        break;
      }
      if (node.points.size() == most_points_)
        fail("a scan of at most " + std::to_string(most_points_) + " points");
      take_point(node, point());
    }
    return true;
  }

  std::vector<std::string> warnings() const override {
    if (beyond_a_turn_ == 0) return {};
    return {"line " + std::to_string(beyond_a_turn_) +
            " has an angle of more than a turn: roll, pitch and yaw are taken as radians."};
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw DamagedGraph("line " + std::to_string(lines_.number()) + ": expected " + expected + ", got " +
                       quote(shortened(line_)));
  }

  void take_pose() {
    std::istringstream words(line_);
    std::string word;
    words >> word;
    std::array<double, 6> values{};
    bool is_whole = word == "NODE";
    for (double& value : values) {
      const auto number = words >> word ? finite_number(word) : std::nullopt;
      is_whole = is_whole && number;
      value = number.value_or(0.0);
    }
    if (!is_whole) fail("'NODE x y z roll pitch yaw'");
    for (const double angle : {values[3], values[4], values[5]})
      if (beyond_a_turn_ == 0 && std::abs(angle) > 6.2832) beyond_a_turn_ = lines_.number();
    pose_ = Eigen::Translation3d(values[0], values[1], values[2]) *
            Eigen::AngleAxisd(values[5], Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(values[4], Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(values[3], Eigen::Vector3d::UnitX());
    has_pose_ = true;
  }

  /// Of the line, whose further columns do not count.
  Eigen::Vector3f point() const {
    Eigen::Vector3f values;
    const char* at = line_.c_str();
    for (float& value : values) {
      at += std::strspn(at, " \t");
      const std::size_t length = std::strcspn(at, " \t");
      const char* const from = at + (*at == '+' ? 1 : 0);
      double number = 0.0;
      const auto end = std::from_chars(from, at + length, number);  // NaN and infinity, too
      value = static_cast<float>(number);
      if (end.ec != std::errc() || end.ptr != at + length) fail("a point 'x y z' or the next 'NODE'");
      at += length;
    }
    return values;
  }

  StreamLines lines_;
  std::size_t most_points_;
  std::string line_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  bool has_pose_ = false;
  std::size_t beyond_a_turn_ = 0;  ///< the first such line; 0: none
};

/// Without the ends of its name that say what it is.
std::string name_of(fs::path file) {
  if (extension_of(file) == ".gz") file = file.stem();
  return file.stem().string();
}

bool is_named_graph(const fs::path& file) {
  return extension_of(extension_of(file) == ".gz" ? file.stem() : file) == ".graph";
}

/// Of a text.
bool begins_with_node(const fs::path& file) {
  try {
    const InputFile input(file, "recording");
    InflatingStream stream(input.descriptor());
    StreamLines lines(stream);
    std::string line;
    while (lines.next(line))
      if (!is_passed_over(line)) return line.starts_with("NODE ") || line.starts_with("NODE\t");
  } catch (const std::runtime_error&) {     // no text, or not gz
  } catch (const std::invalid_argument&) {  // cannot be read
  }
  return false;
}

class ScanGraph final : public FrameSource {
 public:
  ScanGraph(const fs::path& file, const SourceOptions& options)
      : file_(quote_path(file.string())),
        sensor_(name_of(file)),
        points_in_(options.clouds.value_or(CloudFrameOf::sensor)),
        input_(file, "recording"),
        stream_(input_.descriptor()) {
    if (is_named_graph(file) && !begins_with_node(file))
      nodes_ = std::make_unique<BinaryNodes>(stream_, most_points(input_.size()));
    else
      nodes_ = std::make_unique<TextNodes>(stream_, most_points(input_.size()));
  }

  std::optional<Frame> next() override {
    if (has_ended_) return std::nullopt;
    CloudFrame frame;
    frame.kind = "points";
    try {
      has_ended_ = !nodes_->next(frame);
    } catch (const DamagedGraph& error) {
      end_damaged(error.what());
    } catch (const DamagedStream& error) {
      end_damaged(error.what());
    }
    if (has_ended_) return std::nullopt;
    if (points_in_ == CloudFrameOf::map) {
      const Eigen::Isometry3d sensor_from_map = frame.world_from_sensor.inverse();
      for (Eigen::Vector3f& point : frame.points)
        point = (sensor_from_map * point.cast<double>()).cast<float>();
    }
    return Frame{static_cast<double>(count_++), sensor_, std::move(frame)};
  }

  std::optional<std::string> damage() const override {
    return damage_.empty() ? std::nullopt : std::optional(damage_);
  }
  std::vector<std::string> warnings() const override { return nodes_->warnings(); }
  std::string time_caveat() const override {
    if (count_ < 2) return "";
    return "a scan graph holds no times: its scans are taken in their order, as one a second: which scan is "
           "the newest, and ages of voxels, go by that";
  }
  double progress() const override {
    return static_cast<double>(stream_.file_offset()) /
           static_cast<double>(std::max<std::size_t>(input_.size(), 1));
  }

 private:
  void end_damaged(const std::string& clause) {
    has_ended_ = true;
    damage_ =
        "scan graph " + file_ + ", " + clause + "; " +
        (count_ == 0 ? "nothing of it is used" : "of it the " + counted(count_, "scan") + " before are used");
  }

  std::string file_, sensor_;
  CloudFrameOf points_in_;
  InputFile input_;
  InflatingStream stream_;
  std::unique_ptr<GraphNodes> nodes_;
  std::size_t count_ = 0;
  bool has_ended_ = false;
  std::string damage_;
};

}  // namespace

bool is_scan_graph(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  return is_named_graph(file) || begins_with_node(file);
}

std::unique_ptr<FrameSource> open_scan_graph(const fs::path& file, const SourceOptions& options) {
  return std::make_unique<ScanGraph>(file, options);
}

}  // namespace clearway
