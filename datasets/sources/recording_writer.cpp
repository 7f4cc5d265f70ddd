#include <fcntl.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/serialization/CArchive.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "datasets/sources/record_seal.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/file_descriptor.hpp"

namespace clearway {
namespace {

/// Collects what MRPT serialises.
struct ByteSink {
  std::string bytes;
  size_t Write(const void* data, size_t size) {
    bytes.append(static_cast<const char*>(data), size);
    return size;
  }
  size_t Read(void*, size_t) { throw std::logic_error("written only"); }
  std::string getStreamDescription() const { return "memory"; }
};

mrpt::poses::CPose3D mrpt_pose(const Eigen::Isometry3d& pose) {
  mrpt::math::CMatrixDouble44 matrix;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix(row, column) = pose(row, column);
  return mrpt::poses::CPose3D(matrix);
}

mrpt::img::TCamera mrpt_camera(const CameraIntrinsics& camera) {
  mrpt::img::TCamera result;
  result.ncols = static_cast<uint32_t>(camera.width);
  result.nrows = static_cast<uint32_t>(camera.height);
  result.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  if (camera.is_rectified) result.cameraName = rectified_camera_name;
  const auto& d = camera.distortion;
  if (camera.lens == LensModel::fisheye) {
    result.setDistortionKannalaBrandt(d[0], d[1], d[2], d[3]);
  } else {
    result.distortion = mrpt::img::DistortionModel::plumb_bob;
    result.dist = d;  // of a rational lens with k4, k5, k6, as OpenCV reads them there
  }
  return result;
}

mrpt::obs::CObservation::Ptr observation(const ImageFrame& frame) {
  const auto& image = frame.image;
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != static_cast<size_t>(image.width) * static_cast<size_t>(image.height))
    throw std::invalid_argument("an image to record has " + std::to_string(image.pixels.size()) +
                                " pixels; expected width times height of them.");
  auto result = std::make_shared<mrpt::obs::CObservationImage>();
  result->image.resize(image.width, image.height, mrpt::img::CH_GRAY);
  for (int row = 0; row < image.height; ++row)
    std::memcpy(result->image.ptrLine<uint8_t>(row), image.pixels.data() + size_t(row) * image.width,
                static_cast<size_t>(image.width));
  result->cameraParams = mrpt_camera(frame.intrinsics);
  result->cameraPose = mrpt_pose(frame.world_from_sensor);
  return result;
}

mrpt::obs::CObservation::Ptr observation(const CloudFrame& frame) {
  auto result = std::make_shared<mrpt::obs::CObservation3DRangeScan>();
  result->hasPoints3D = true;
  for (const auto& point : frame.points) {
    result->points3D_x.push_back(point.x());
    result->points3D_y.push_back(point.y());
    result->points3D_z.push_back(point.z());
  }
  result->points3D_idxs_x.resize(frame.points.size());
  result->points3D_idxs_y.resize(frame.points.size());
  result->maxRange = static_cast<float>(frame.max_range);
  result->sensorPose = mrpt_pose(frame.world_from_sensor);
  return result;
}

mrpt::obs::CObservation::Ptr observation(const OdometryFrame& frame) {
  auto result = std::make_shared<mrpt::obs::CObservationOdometry>();
  result->odometry = mrpt::poses::CPose2D(mrpt_pose(frame.world_from_robot));
  return result;
}

mrpt::obs::CObservation::Ptr observation(const CommentFrame& frame) {
  auto result = std::make_shared<mrpt::obs::CObservationComment>();
  result->text = frame.text;
  return result;
}

mrpt::obs::CObservation::Ptr observation(const DepthImage& depth) {
  const auto& camera = depth.intrinsics;
  if (camera.width <= 0 || camera.height <= 0 ||
      depth.ranges.size() != static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height))
    throw std::invalid_argument("a depth image to record has " + std::to_string(depth.ranges.size()) +
                                " ranges; expected width times height of them.");
  auto result = std::make_shared<mrpt::obs::CObservation3DRangeScan>();
  result->hasRangeImage = true;
  result->range_is_depth = false;
  result->rangeUnits = static_cast<float>(depth.unit);
  result->rangeImage_setSize(camera.height, camera.width);
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const double steps = std::round(depth.ranges[size_t(row) * camera.width + column] / depth.unit);
      result->rangeImage(row, column) = static_cast<uint16_t>(steps > 0 && steps < 65535 ? steps : 0);
    }
  result->cameraParams = result->cameraParamsIntensity = mrpt_camera(camera);
  result->maxRange = static_cast<float>(depth.max_range);
  result->sensorPose = mrpt_pose(depth.world_from_sensor);
  return result;
}

/// Takes the bytes of a log.
class LogFile {
 public:
  LogFile(const std::filesystem::path& file, UnfinishedRecording unfinished) : file_(file) {
    if (unfinished == UnfinishedRecording::removed) {
      whole_.emplace(file);
      return;
    }
    growing_ = FileDescriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!growing_.is_open()) fail_to_write(file);
  }

  void append(const std::string& bytes) {
    whole_ ? whole_->append(bytes) : write_all(growing_, bytes, file_);
  }

  void finish() {
    if (whole_)
      whole_->finish();
    else if (::fsync(growing_.number()) != 0)
      fail_to_write(file_);
  }

 private:
  std::filesystem::path file_;
  std::optional<AtomicFile> whole_;
  FileDescriptor growing_;
};

}  // namespace

struct RecordingWriter::State {
  State(const std::filesystem::path& target, UnfinishedRecording unfinished) : file(target, unfinished) {}

  void append(double time, const std::string& sensor, mrpt::obs::CObservation& observation) {
    observation.timestamp = mrpt::Clock::fromDouble(time);
    observation.sensorLabel = sensor;
    ByteSink sink;
    mrpt::serialization::archiveFrom(sink) << observation;
    append(sealed_record(sink.bytes, {.index = count++, .time = time}));
  }

  void append(const std::string& record) {
    file.append(record);
    sum.crc32 = static_cast<std::uint32_t>(
        ::crc32_z(sum.crc32, reinterpret_cast<const Bytef*>(record.data()), record.size()));
    sum.bytes += record.size();
  }

  LogFile file;
  std::uint32_t count = 0;
  RecordingSum sum;
  bool has_ended = false;
};

double recorded_time(double time) { return mrpt::Clock::toDouble(mrpt::Clock::fromDouble(time)); }

RecordingWriter::RecordingWriter(const std::filesystem::path& file, UnfinishedRecording unfinished)
    : state_(std::make_unique<State>(file, unfinished)) {}
RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::write(const Frame& frame) {
  const auto object = std::visit([](const auto& content) { return observation(content); }, frame.content);
  state_->append(frame.time, frame.sensor, *object);
}

void RecordingWriter::write(double time, const std::string& sensor, const DepthImage& depth) {
  state_->append(time, sensor, *observation(depth));
}

RecordingSum RecordingWriter::end() {
  if (!state_->has_ended) state_->append(sealed_record("", {.index = state_->count, .is_end = true}));
  state_->has_ended = true;
  return state_->sum;
}

void RecordingWriter::finish() {
  end();
  state_->file.finish();
}

}  // namespace clearway
