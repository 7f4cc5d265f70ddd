#include "datasets/pictures/video.hpp"

#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <new>
#include <opencv2/videoio.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "datasets/pictures/video_times.hpp"
#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t video_memory = 2048ULL << 20U;  ///< reference pictures, and room for its threads

/// Luma of a picture in blue, green, red (ITU-R BT.601). Not cv::cvtColor: its threads may be missing in a
/// forked process.
GrayImage luma(const cv::Mat& picture) {
  GrayImage image{picture.cols, picture.rows, {}};
  image.pixels.reserve(picture.total());
  const int channels = picture.channels();
  for (int row = 0; row < picture.rows; ++row) {
    const unsigned char* pixel = picture.ptr(row);
    for (int column = 0; column < picture.cols; ++column, pixel += channels) {
      const unsigned sum =
          channels < 3 ? 16384U * pixel[0] : 1868U * pixel[0] + 9617U * pixel[1] + 4899U * pixel[2];
      image.pixels.push_back(static_cast<std::uint8_t>((sum + 8192U) >> 14U));
    }
  }
  return image;
}

/// OpenCV's video, with the hundred libraries of ffmpeg, is loaded by the child that decodes one: nobody else
/// needs their 18 MB. Its C interface reads none any more, so the constructor is looked up; all other
/// functions of the class that are called are virtual.
class LoadedCapture {
 public:
  /// @throws std::runtime_error a clause that says why videos cannot be decoded.
  LoadedCapture() {
    void* const library = ::dlopen(CLEARWAY_VIDEOIO, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error("OpenCV's library for videos is not installed");
    using Construct = void (*)(void*);
    const auto construct = reinterpret_cast<Construct>(::dlsym(library, "_ZN2cv12VideoCaptureC1Ev"));
    if (construct == nullptr) throw std::runtime_error("OpenCV's library for videos is of another version");
    construct(memory_);
    capture_ = std::launder(reinterpret_cast<cv::VideoCapture*>(memory_));
  }
  LoadedCapture(const LoadedCapture&) = delete;
  LoadedCapture& operator=(const LoadedCapture&) = delete;

  cv::VideoCapture* operator->() const { return capture_; }  // open until the child ends

 private:
  alignas(cv::VideoCapture) std::byte memory_[sizeof(cv::VideoCapture)];
  cv::VideoCapture* capture_ = nullptr;
};

void send_picture(const ChildReport& report, double time, const cv::Mat& picture, double share) {
  DecodedFrame decoded;
  decoded.frame.time = time;
  ImageFrame image;
  image.image = luma(picture);
  decoded.frame.content = std::move(image);
  report.send(ChildMessage::frame, static_cast<std::uint64_t>(1e6 * share), frame_to_bytes(decoded));
}

/// What reads the video, in the child. `offset` of its messages is the share that is read, in millionths.
/// @throws std::runtime_error a clause that says why it cannot be decoded.
void decode_video(const ChildReport& report, const std::string& file, std::optional<double> rate) {
  LoadedCapture capture;
  if (!capture->open(file, cv::CAP_FFMPEG)) throw std::runtime_error("it cannot be decoded");
  capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // a calibration belongs to the sensor, as with EXIF
  const VideoTimes video = read_video_times(file);
  PictureClock clock(video, std::max(capture->get(cv::CAP_PROP_FPS), 1e-3));
  const auto expected = static_cast<double>(std::max<std::size_t>(video.shown, 1));
  std::size_t number = 0, timeless = 0;
  cv::Mat picture;
  for (; capture->read(picture) && !picture.empty(); ++number) {
    const auto time = clock.next(capture->get(cv::CAP_PROP_POS_MSEC) / 1000.0);
    if (rate || time)
      send_picture(report, rate ? static_cast<double>(number) / *rate : *time, picture,
                   std::min(1.0, static_cast<double>(number) / expected));
    else
      ++timeless;
  }
  if (number == 0) throw std::runtime_error("it holds no picture that can be decoded");
  if (video.leading > 0)
    report.send(ChildMessage::skipped, 0,
                "its first " + counted(video.leading, "picture needs", "pictures need") +
                    " ones that are not in it: left out");
  if (video.times.empty() && !rate)
    report.send(ChildMessage::skipped, 0,
                "it does not say when its pictures are shown: they are taken as evenly apart");
  if (timeless > 0)
    report.send(ChildMessage::skipped, 0,
                "it holds no times of its last " + counted(timeless, "picture") + ": left out");
  if (video.is_cut && video.stated == 0)
    throw std::runtime_error("the file ends within it, after " + counted(number, "picture"));
  const std::size_t said = video.is_cut ? video.stated : video.shown;
  if (number + 1 < said) {
    const std::string fewer =
        "it says that it holds " + counted(said, "picture") + ", and " + std::to_string(number) +
        " could be decoded" +
        (rate || clock.sees_gaps() ? "" : "; which are missing is not known: times may be off");
    constexpr double most_broken =
        0.1;  // of containers that state how many pictures they have: others have packets
    if (video.is_cut || (video.stated > 0 && static_cast<double>(number) < (1.0 - most_broken) * expected))
      throw std::runtime_error(fewer);
    report.send(ChildMessage::skipped, 0, fewer);
  }
  report.send(ChildMessage::end, 1'000'000, "");
}

/// What watches a camera, in the child. Whoever takes long with a picture loses those that come meanwhile.
/// @throws std::runtime_error a clause that says why it gives no pictures.
void watch_camera(const ChildReport& report, const std::string& device, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto elapsed = [begin = Clock::now()] {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  LoadedCapture capture;
  if (!capture->open(device, cv::CAP_V4L2)) throw std::runtime_error("it cannot be opened as a camera");
  capture->set(cv::CAP_PROP_BUFFERSIZE, 1);  // where the driver can: nothing waits in line
  const double period = 1.0 / std::max(capture->get(cv::CAP_PROP_FPS), 1.0);
  cv::Mat picture;
  bool is_any = false;
  while (elapsed() < seconds && capture->grab()) {
    const double time =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (!capture->retrieve(picture) || picture.empty()) continue;
    const double sent = elapsed();
    send_picture(report, time, picture, std::min(1.0, sent / seconds));
    is_any = true;
    if (elapsed() - sent > period) capture->grab();  // taken before somebody had time for it
  }
  if (!is_any) throw std::runtime_error("it gave no picture");
  if (elapsed() < seconds) throw std::runtime_error("it stopped giving pictures");
  report.send(ChildMessage::end, 1'000'000, "");
}

/// True for a device of Video4Linux.
bool is_camera(const std::filesystem::path& device) {
  constexpr unsigned video4linux = 81;
  struct stat status {};
  return ::stat(device.c_str(), &status) == 0 && S_ISCHR(status.st_mode) &&
         major(status.st_rdev) == video4linux;
}

/// The pictures that a child makes.
class Video final : public FrameSource {
 public:
  using Work = std::function<void(const ChildReport&)>;

  /// @param kind what the source is, in sentences. @param work throws std::runtime_error.
  Video(const std::string& kind, const std::filesystem::path& file, const SourceOptions& options,
        std::uint64_t seconds, const Work& work)
      : name_(kind + " " + quote_path(file.string())),
        sensor_(file.stem().string()),
        camera_(options.camera),
        child_({.memory = video_memory, .seconds = seconds}, -1, [work](const ChildReport& report, int) {
          try {
            work(report);
          } catch (const std::runtime_error& error) {
            report.send(ChildMessage::damage, 0, error.what());
          }
        }) {}

  std::optional<Frame> next() override {
    while (!ended_) {
      const ChildMessage message = child_.receive();
      progress_ = std::max(progress_, static_cast<double>(message.offset) / 1e6);
      if (message.kind == ChildMessage::skipped) {
        warnings_.push_back(name_ + ": " + message.text);
      } else if (message.kind == ChildMessage::frame) {
        try {
          Frame frame = frame_from_bytes(message.text).frame;
          if (auto* image = std::get_if<ImageFrame>(&frame.content); image != nullptr && camera_)
            image->intrinsics = *camera_;
          frame.sensor = sensor_;
          return frame;
        } catch (const std::runtime_error& error) {
          end(error.what());
        }
      } else {
        end(message.kind == ChildMessage::end ? "" : message.text);
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  double progress() const override { return std::min(1.0, progress_); }
  bool is_live() const override { return name_.starts_with("camera"); }

 private:
  void end(const std::string& why) {
    ended_ = true;
    if (!why.empty()) damage_ = name_ + (name_.starts_with("camera") ? ": " : " is damaged: ") + why;
  }

  std::string name_, sensor_;
  std::optional<CameraIntrinsics> camera_;
  DecodingChild child_;
  bool ended_ = false;
  double progress_ = 0.0;
  std::optional<std::string> damage_;
  std::vector<std::string> warnings_;
};

}  // namespace

bool is_video_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  const InputFile input(file, "recording");
  // A transport stream has no head: packets of 188 bytes, or 192 with a time before each, begin with 0x47.
  std::string head(400, '\0');
  const ssize_t size = ::pread(input.descriptor(), head.data(), head.size(), 0);
  if (size < 12) return false;
  head.resize(static_cast<std::size_t>(size));
  const std::string_view bytes(head);
  const auto is_packet = [&](std::size_t at) { return at < bytes.size() && bytes[at] == 0x47; };
  return bytes.substr(4, 4) == "ftyp" || bytes.starts_with("\x1a\x45\xdf\xa3") ||
         (bytes.starts_with("RIFF") && bytes.substr(8, 4) == "AVI ") || bytes.starts_with("OggS") ||
         bytes.starts_with(std::string_view("\0\0\1\xba", 4)) ||
         (is_packet(0) && is_packet(188) && is_packet(376)) ||
         (is_packet(4) && is_packet(196) && is_packet(388));
}

std::unique_ptr<FrameSource> open_video(const std::filesystem::path& file, const SourceOptions& options) {
  return std::make_unique<Video>(
      "video", file, options, DecodingLimits::of_file(InputFile(file, "video").size()).seconds,
      [path = std::filesystem::absolute(file).string(), rate = options.rate](const ChildReport& report) {
        decode_video(report, path, rate);
      });
}

std::unique_ptr<FrameSource> open_camera(const std::filesystem::path& device, const SourceOptions& options) {
  if (!is_camera(device))
    throw std::invalid_argument("camera " + quote_path(device.string()) + ": there is no such camera");
  const double seconds = options.camera_seconds;
  return std::make_unique<Video>(
      "camera", device, options, 60 + 10 * static_cast<std::uint64_t>(seconds),
      [path = device.string(), seconds](const ChildReport& report) { watch_camera(report, path, seconds); });
}

}  // namespace clearway
