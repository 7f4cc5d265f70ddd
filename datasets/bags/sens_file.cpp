#include "datasets/bags/sens_file.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

#include "datasets/bags/sens_layout.hpp"
#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/pictures/depth_casting.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/sources/decoding_child.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t largest_sens_part = std::uint64_t{64} << 20U;  ///< bytes of a picture

std::string bytes_of_part(const InputFile& file, const FilePart& part) {
  if (part.size > largest_sens_part) throw std::runtime_error("it has more than 64 MB");
  std::string bytes;
  file.read_at(part.at, part.size, bytes);
  return bytes;
}

/// What of a frame is read, by whom, in the child.
struct SensWork {
  std::filesystem::path file;
  SensLayout layout;
  std::vector<double> times;  ///< s, of each frame
  SourceOptions options;
  CameraIntrinsics colour_camera;
  FilesInChild::Decode decode;  ///< of a depth picture
};

void send_sens_frame(const ChildReport& report, const InputFile& input, const SensWork& work, std::size_t i) {
  const SensFrame& frame = work.layout.frames[i];
  DecodedFrame decoded;
  decoded.frame.time = work.times[i];
  if (work.options.places_depth || frame.world_from_camera) {
    decoded.frame.sensor = "depth";
    auto content = work.decode(pgm_of_sens(bytes_of_part(input, frame.depth), work.layout), 0);
    if (!work.options.places_depth)
      std::get<CloudFrame>(content).world_from_sensor = *frame.world_from_camera * optical_from_sensor();
    decoded.frame.content = std::move(content);
    report.send(ChildMessage::frame, i, frame_to_bytes(decoded));
  }
  if (!work.layout.has_pictures) return;
  ImageFrame image;
  image.image = decode_picture(bytes_of_part(input, frame.colour));
  image.intrinsics = work.colour_camera;
  decoded.frame.sensor = "colour";
  decoded.frame.content = std::move(image);
  report.send(ChildMessage::frame, i, frame_to_bytes(decoded));
}

void decode_sens(const ChildReport& report, const SensWork& work) {
  const InputFile input(work.file, "recording");
  for (std::size_t i = 0; i < work.layout.frames.size(); ++i) {
    try {
      send_sens_frame(report, input, work, i);
    } catch (const std::bad_alloc&) {
      report.send(ChildMessage::skipped, i, "it asks for more memory than it may take");
    } catch (const std::exception& error) {
      report.send(ChildMessage::skipped, i, error.what());
    }
  }
  report.send(ChildMessage::end, work.layout.frames.size(), "");
}

class SensFile final : public FrameSource {
 public:
  SensFile(SensWork work, std::string time_caveat, std::vector<std::string> notes, std::uint64_t bytes)
      : name_("recording " + quote_path(work.file.string())),
        frames_(work.layout.frames.size()),
        cut_(work.layout.damage),
        time_caveat_(std::move(time_caveat)),
        notes_(std::move(notes)),
        child_(limits_of(work.layout, bytes), -1,
               [work = std::move(work)](const ChildReport& report, int) { decode_sens(report, work); }) {}

  std::optional<Frame> next() override {
    while (!has_ended_) {
      const ChildMessage message = child_.receive();
      at_ = std::max(at_, static_cast<std::size_t>(message.offset));
      if (message.kind == ChildMessage::skipped) {
        damage_.note(name_ + ": frame " + std::to_string(message.offset) + " is damaged: " + message.text);
      } else if (message.kind != ChildMessage::frame) {
        has_ended_ = true;
        if (message.kind != ChildMessage::end)
          damage_.note(name_ + " is damaged: " + message.text);
        else if (!cut_.empty())
          damage_.note(name_ + " is damaged: " + cut_);
      } else {
        try {
          return frame_from_bytes(message.text).frame;
        } catch (const std::runtime_error& error) {
          has_ended_ = true;
          damage_.note(name_ + " is damaged: " + error.what());
        }
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_.sentence(frames_, "frames"); }
  std::vector<std::string> warnings() const override { return notes_; }
  std::string time_caveat() const override { return time_caveat_; }
  double progress() const override {
    return frames_ == 0 ? 1.0 : static_cast<double>(std::min(at_, frames_)) / static_cast<double>(frames_);
  }

 private:
  static DecodingLimits limits_of(const SensLayout& layout, std::uint64_t bytes) {
    std::uint64_t largest = 0;
    for (const SensFrame& frame : layout.frames)
      largest = std::max({largest, std::min(frame.colour.size, largest_sens_part),
                          std::min(frame.depth.size, largest_sens_part)});
    constexpr std::uint64_t decoder_memory = std::uint64_t{256} << 20U;
    return {.memory = decoder_memory + 20 * largest, .seconds = DecodingLimits::of_file(bytes).seconds};
  }

  std::string name_;
  std::size_t frames_;
  std::string cut_;  ///< a clause: why frames are missing
  std::string time_caveat_;
  std::vector<std::string> notes_;
  DecodingChild child_;
  FolderDamage damage_;
  std::size_t at_ = 0;
  bool has_ended_ = false;
};

/// By the rate, else the file's microseconds where they rise; else one a second.
std::vector<double> times_of_sens(const SensLayout& layout, std::optional<double> rate, std::string& caveat) {
  const std::vector<SensFrame>& frames = layout.frames;
  const bool do_rise = std::adjacent_find(frames.begin(), frames.end(), [](const auto& a, const auto& b) {
                         return b.depth_time <= a.depth_time;
                       }) == frames.end();
  if (!rate && !do_rise)
    caveat =
        "the frames have no rising times: they are taken as one a second; `rate` of `source` in the setup "
        "gives "
        "true ones";
  std::vector<double> times;
  for (std::size_t i = 0; i < frames.size(); ++i)
    times.push_back(rate      ? static_cast<double>(i) / *rate
                    : do_rise ? 1e-6 * static_cast<double>(frames[i].depth_time)
                              : static_cast<double>(i));
  return times;
}

/// Says how many frames have no pose, and why.
void note_unposed(const SensLayout& layout, std::vector<std::string>& notes) {
  const auto note = [&](std::ptrdiff_t count, const char* lack) {
    if (count > 0)
      notes.push_back(std::to_string(count) + " of " + std::to_string(layout.frames.size()) +
                      " frames have " + lack + ", and their depth was left out");
  };
  if (layout.is_untracked)
    notes.emplace_back(
        "all its poses are the identity, as of a recording that was never tracked, and are taken as none");
  const auto begin = layout.frames.begin(), end = layout.frames.end();
  const auto bent = std::count_if(begin, end, [](const SensFrame& frame) { return frame.is_bent; });
  const auto unposed =
      std::count_if(begin, end, [](const SensFrame& frame) { return !frame.world_from_camera; });
  note(bent, "a pose that is no rigid transform");
  note(unposed - bent, "no pose");
}

std::vector<std::string> notes_of_sens(const SensLayout& layout, const SourceOptions& options) {
  std::vector<std::string> notes;
  if (!options.depth.camera)
    notes.emplace_back(
        "the depth pictures' camera, and poses, are those in the file; `source: {depth: {camera: …}}` states "
        "another camera.");
  if (!options.depth.scale)
    notes.push_back("steps of depth are " + short_text(layout.step) +
                    " m, by the file; `source: {depth: {scale: …}}` states others.");
  if (!options.places_depth) note_unposed(layout, notes);
  if (!layout.has_pictures) notes.emplace_back("colours are neither PNG nor JPEG and are not read.");
  return notes;
}

}  // namespace

bool is_sens_file(const std::filesystem::path& file) { return extension_of(file) == ".sens"; }

std::unique_ptr<FrameSource> open_sens(const std::filesystem::path& file, const SourceOptions& options) {
  const std::string name = "recording " + quote_path(file.string());
  if (!options.depth.poses.empty())
    throw std::invalid_argument(name +
                                " has poses of its own: expected no `poses` of `source: {depth: …}` in the "
                                "setup; `sensors: [{name: depth, poses: …}]` states others");
  const InputFile input(file, "recording");
  SensWork work{std::filesystem::absolute(file), {}, {}, options, {}, {}};
  try {
    work.layout = read_sens_layout(input.size(), [&](std::uint64_t at, std::size_t count) {
      std::string piece;
      input.read_at(at, count, piece);
      return piece;
    });
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(name + " is damaged, or no .sens of ScanNet: " + error.what());
  }
  if (work.layout.frames.empty())
    throw std::invalid_argument(name + ": expected at least one frame" +
                                (work.layout.damage.empty() ? "" : "; " + work.layout.damage));
  if (work.layout.is_depth_moved && !options.places_depth)
    throw std::invalid_argument(
        name +
        ": the extrinsic of its depth camera is not the identity, and does not say which camera the poses "
        "are "
        "of; expected `sensors: [{name: depth, poses: …, pose: …}]` in the setup to place the depth");
  std::vector<std::string> notes = notes_of_sens(work.layout, options);
  std::string caveat;
  work.times = times_of_sens(work.layout, options.rate, caveat);
  if (!work.options.depth.scale) work.options.depth.scale = work.layout.step;
  work.colour_camera = options.camera.value_or(work.layout.colour);
  work.decode = depth_decoder({{options.depth.camera.value_or(work.layout.depth)}, false}, work.options.depth,
                              DepthNumbers{}, {std::filesystem::path()});
  return std::make_unique<SensFile>(std::move(work), std::move(caveat), std::move(notes), input.size());
}

}  // namespace clearway
