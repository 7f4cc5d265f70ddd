#include "apps/fusion/frame_source.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

class Rawlog final : public FrameSource {
 public:
  explicit Rawlog(const fs::path& file) : reader_(file) {}
  std::optional<Frame> next() override { return reader_.next(); }
  std::optional<std::string> damage() const override { return reader_.damage(); }
  std::vector<std::string> warnings() const override { return reader_.warnings(); }
  double progress() const override { return reader_.progress(); }

 private:
  RecordingReader reader_;
};

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Cloud files as scans. When every name is a number they are times and tell the order.
class Clouds final : public FrameSource {
 public:
  Clouds(std::vector<fs::path> files, std::string sensor)
      : files_(std::move(files)), sensor_(std::move(sensor)) {
    timed_ = std::all_of(files_.begin(), files_.end(),
                         [](const fs::path& file) { return number_of(file.stem().string()).has_value(); });
    std::sort(files_.begin(), files_.end(), [this](const fs::path& a, const fs::path& b) {
      if (!timed_) return a.filename() < b.filename();
      return *number_of(a.stem().string()) < *number_of(b.stem().string());
    });
  }

  std::optional<Frame> next() override {
    while (at_ < files_.size()) {
      const fs::path& file = files_[at_];
      const double time = timed_ ? *number_of(file.stem().string()) : static_cast<double>(at_);
      ++at_;
      try {
        const ViewedCloud cloud = read_viewed_cloud(file);
        CloudFrame frame;
        frame.kind = "points";
        frame.world_from_sensor = cloud.file_from_viewpoint;
        const Eigen::Isometry3f sensor_from_file = cloud.file_from_viewpoint.inverse().cast<float>();
        frame.points.reserve(cloud.points.size());
        for (const Eigen::Vector3f& point : cloud.points) frame.points.push_back(sensor_from_file * point);
        return Frame{time, sensor_, std::move(frame)};
      } catch (const DamagedFile& error) {  // the other files are whole
        if (!damage_) damage_ = error.what();
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_; }
  std::vector<std::string> warnings() const override { return {}; }
  double progress() const override { return static_cast<double>(at_) / static_cast<double>(files_.size()); }

 private:
  std::vector<fs::path> files_;
  std::string sensor_;
  bool timed_ = false;
  std::size_t at_ = 0;
  std::optional<std::string> damage_;
};

}  // namespace

std::unique_ptr<FrameSource> open_frames(const fs::path& recording) {
  std::error_code error;
  if (fs::is_directory(recording, error)) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(recording)) {
      if (entry.is_regular_file() && is_cloud_file(entry.path())) files.push_back(entry.path());
    }
    if (files.empty()) {
      throw std::invalid_argument("recording '" + recording.string() +
                                  "' is a folder without .pcd and .ply files; expected those, or a rawlog");
    }
    const fs::path whole = recording.has_filename() ? recording : recording.parent_path();
    return std::make_unique<Clouds>(std::move(files), whole.filename().string());
  }
  if (is_cloud_file(recording) && fs::is_regular_file(recording, error)) {
    return std::make_unique<Clouds>(std::vector<fs::path>{recording}, recording.stem().string());
  }
  return std::make_unique<Rawlog>(recording);
}

}  // namespace clearway
