#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace clearway {

/// A grey image, row by row from the top, 0 = black.
struct GrayImage {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;

  bool operator==(const GrayImage&) const = default;
};

/// How a lens bends rays, with OpenCV's coefficients in OpenCV's order.
enum class LensModel : std::uint8_t {
  plumb_bob,  ///< k1 k2 p1 p2 k3 (Brown-Conrady; kalibr's radtan)
  rational,   ///< k1 k2 p1 p2 k3 k4 k5 k6 (CALIB_RATIONAL_MODEL; ROS: rational_polynomial)
  fisheye,    ///< k1 k2 k3 k4 of the angle (Kannala and Brandt; cv::fisheye; ROS and kalibr: equidistant)
};

/// A camera, in pixels. Pixel (0, 0) is the *centre* of the top left pixel (OpenCV's convention); width 0
/// means "not known".
struct CameraIntrinsics {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 8> distortion{};  ///< as many as the lens has, the rest 0
  LensModel lens = LensModel::plumb_bob;
  bool is_rectified =
      false;  ///< pictures were freed of a known distortion: that `distortion` is 0 is measured

  bool operator==(const CameraIntrinsics&) const = default;
};

/// By this name of a camera a rawlog says that its pictures are rectified.
constexpr const char* rectified_camera_name = "rectified";

/// What a camera saw. The sensor frame is the optical one: x right, y down, z forward.
struct ImageFrame {
  GrayImage image;
  CameraIntrinsics intrinsics;
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
};

/// What a range sensor measured: valid returns only, in the sensor frame (x forward, y left, z up).
struct CloudFrame {
  std::vector<Eigen::Vector3f> points;
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  double max_range = 0;  ///< m, 0 when the recording does not say
  std::string kind;      ///< "depth", "laser2d", "velodyne" or "points"
  /// Points that are not among them: not finite, or at the sensor's origin, where drivers put what did not
  /// come back.
  std::size_t unusable = 0;
  /// Beams of a 2D laser that said +inf, or no less than its range: nothing within it (REP 117), or, of some
  /// drivers, no answer.
  std::size_t infinite = 0;
  std::size_t at_range = 0;                 ///< of these, the ones that are not +inf
  std::vector<Eigen::Vector3f> clear_to{};  ///< where these reach the laser's range, if it is known
  bool is_origin_known = true;              ///< else points say what is occupied, and no rays lead to them
  std::vector<float> times{};  ///< s after the frame's, of each point; none: all at once, or not known
};

/// Adds a point to the cloud, or counts it as not usable.
inline void take_point(CloudFrame& cloud, const Eigen::Vector3f& point) {
  if (point.allFinite() && !point.isZero(0.0F))
    cloud.points.push_back(point);
  else
    ++cloud.unusable;
}

/// Where the robot that carries the sensors is, by its odometry.
struct OdometryFrame {
  Eigen::Isometry3d world_from_robot = Eigen::Isometry3d::Identity();
};

/// A text put into the recording. `simulate` stores the setup's YAML so, as the first object.
struct CommentFrame {
  std::string text;
};

/// One thing that happened in a recording. `time` is in seconds since 1970; an object without a time stamp
/// gets that of the one before it (at the beginning: of the first one that has it; 0 when none has).
struct Frame {
  double time = 0;
  std::string sensor;  ///< the sensor's label, may be empty; MRPT stores none with a comment
  std::variant<ImageFrame, CloudFrame, OdometryFrame, CommentFrame> content;
  std::string file = {};  ///< name of the file that holds this frame alone; empty: one file holds them all
};

/// A range image as a depth camera makes it, for writing. The sensor frame is x forward, y left, z up.
struct DepthImage {
  CameraIntrinsics intrinsics;
  std::vector<float> ranges;  ///< m along the ray of each pixel, row by row; 0 = no return
  double unit = 1e-3;         ///< m per step of the stored 16 bit number: finer steps, shorter reach
  double max_range = 0;       ///< m
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
};

/// What a reader has met so far.
struct RecordingCounts {
  size_t objects = 0;  ///< whole objects at the top level of the file
  size_t images = 0, clouds = 0, odometry = 0, comments = 0;
  size_t lost = 0;     ///< records, or runs of them, that do not pass their checksums and are not used
  size_t skipped = 0;  ///< observations of kinds Clearway has no use for, or stored in other files
};

/// Reads an MRPT rawlog (plain or gz) frame by frame, in file order, each frame with its pose in the world:
/// sensor pose on the robot after the robot's odometry, where the log has one. Logs of actions and sensory
/// frames add up the increments; observation-only logs interpolate the odometry in time (and hold back up to
/// 32 frames to wait for the next odometry). A log without odometry has its robot at the origin.
///
/// The file is decoded in a child process with bounded memory and time, so that no damaged file can take
/// this process down: damage ends the reading with `damage()` set, and every frame before it is kept.
class RecordingReader {
 public:
  /// @throws std::invalid_argument when the file is missing, not readable or not a rawlog at all.
  explicit RecordingReader(const std::filesystem::path& file);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  /// The next frame, or nothing at the end of the log or where damage begins.
  std::optional<Frame> next();

  /// One sentence naming the file, the object and the place, once `next` has met damage. In a recording that
  /// RecordingWriter wrote, every record has a checksum: one that does not pass is named with its number and
  /// time, left out, and reading goes on; the sentence grows. In others damage ends the reading; a frame read
  /// before a failing checksum at the end may itself be wrong: the sentence says when that is so.
  const std::optional<std::string>& damage() const;
  /// One sentence for each kind of thing that was left out (an image stored in another file, say).
  const std::vector<std::string>& warnings() const;
  const RecordingCounts& counts() const;
  /// How much of the file has been read, 0 to 1.
  double progress() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a rawlog keeps of a time, s: its clock has steps of 100 ns.
double recorded_time(double time);

/// By what a file beside a recording names it: of all its bytes.
struct RecordingSum {
  std::uint64_t bytes = 0;
  std::uint32_t crc32 = 0;
};

/// What becomes of a recording that is not finished.
enum class UnfinishedRecording {
  removed,  ///< it leaves nothing under its name (AtomicFile); of a crash, a temporary file until the next
            ///< one
  kept      ///< it is there under its name from the beginning, to be read up to its last frame
};

/// Writes a gz rawlog, each record under a checksum of its own (record_seal.hpp). Each frame is flushed as it
/// is written. The same frames give the same bytes.
class RecordingWriter {
 public:
  /// @throws std::runtime_error when the folder or the file cannot be written; one to be kept may not be
  /// there
  explicit RecordingWriter(const std::filesystem::path& file,
                           UnfinishedRecording unfinished = UnfinishedRecording::removed);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Appends one object. A cloud is stored as bare points and reads back as kind "points"; odometry keeps x,
  /// y and yaw. @throws std::invalid_argument for an image whose size does not fit its pixels,
  /// std::runtime_error when the disk refuses.
  void write(const Frame& frame);
  /// Appends a depth image; reads back as a cloud of kind "depth". Ranges beyond 65534 units are dropped.
  void write(double time, const std::string& sensor, const DepthImage& depth);
  /// Ends the log, which `finish` publishes. Nothing may be written afterwards but by `finish`.
  RecordingSum end();
  /// Ends the log, syncs it to the disk and gives it its name, if it lacks that. Nothing may be written
  /// afterwards.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
