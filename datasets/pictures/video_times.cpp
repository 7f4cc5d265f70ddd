#include "datasets/pictures/video_times.hpp"

#include <dlfcn.h>

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr double same_time = 0.0011;  ///< s: Matroska rounds to milliseconds

/// FFmpeg's functions, loaded like OpenCV's video: by the child that reads one.
class LoadedFormats {
 private:
  static void* load(const char* name) {
    void* const library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error("FFmpeg's library for videos is not installed");
    return library;
  }
  template <typename Function>
  static Function function(void* library, const char* name) {
    void* const found = ::dlsym(library, name);
    if (found == nullptr) throw std::runtime_error("FFmpeg's library for videos is of another version");
    return reinterpret_cast<Function>(found);
  }

  void* formats_ = load("libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR));
  void* codecs_ = load("libavcodec.so." AV_STRINGIFY(LIBAVCODEC_VERSION_MAJOR));

 public:
  decltype(&avformat_open_input) open = function<decltype(open)>(formats_, "avformat_open_input");
  decltype(&avformat_find_stream_info) look = function<decltype(look)>(formats_, "avformat_find_stream_info");
  decltype(&av_read_frame) read = function<decltype(read)>(formats_, "av_read_frame");
  decltype(&av_packet_alloc) packet = function<decltype(packet)>(codecs_, "av_packet_alloc");
  decltype(&av_packet_unref) release = function<decltype(release)>(codecs_, "av_packet_unref");
};

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t number = 0;
  for (const char byte : bytes) number = number << 8U | static_cast<unsigned char>(byte);
  return number;
}

/// A number of Matroska (RFC 8794, section 4), and how many bytes it has; empty: unknown, or none.
std::pair<std::optional<std::uint64_t>, std::size_t> matroska_size(std::string_view bytes) {
  std::size_t length = 1;
  if (bytes.empty() || bytes[0] == 0) return {std::nullopt, 1};
  while ((static_cast<unsigned char>(bytes[0]) & (0x80U >> (length - 1))) == 0) ++length;
  if (bytes.size() < length) return {std::nullopt, length};
  const std::uint64_t mask = (std::uint64_t{1} << (7 * length)) - 1;
  const std::uint64_t number = big_endian(bytes.substr(0, length)) & mask;
  return {number == mask ? std::nullopt : std::optional(number), length};
}

/// Whether an AVI's or Matroska's outermost chunk, or a box of an MP4, ends behind the file.
bool is_cut_video(const std::string& file) {
  const InputFile input(file, "video");
  std::string head;
  input.read_at(0, std::min<std::uint64_t>(64, input.size()), head);
  if (head.size() >= 16 && head.starts_with("RIFF"))
    return big_endian(std::string{head[7], head[6], head[5], head[4]}) + 8 > input.size();
  if (head.starts_with("\x1a\x45\xdf\xa3")) {
    const auto [header, bytes] = matroska_size(std::string_view(head).substr(4));
    const std::size_t segment = 4 + bytes + header.value_or(64);
    if (segment + 12 > head.size() || head.compare(segment, 4, "\x18\x53\x80\x67") != 0) return false;
    const auto [size, more] = matroska_size(std::string_view(head).substr(segment + 4));
    return size && *size > input.size() - segment - 4 - more;
  }
  if (head.size() < 16 || head.compare(4, 4, "ftyp") != 0) return false;
  for (std::uint64_t at = 0; at + 16 <= input.size();) {
    input.read_at(at, 16, head);
    std::uint64_t length = big_endian(std::string_view(head).substr(0, 4));
    if (length == 1) length = big_endian(std::string_view(head).substr(8, 8));
    if (length == 0) return false;  // up to the end
    if (length < 8 || length > input.size() - at) return true;
    at += length;
  }
  return false;
}

/// Whether each picture that is decoded is shown when the packet comes that lets it out: as encoders of H.264
/// choose the times of decoding. @param decoding, times both sorted
bool is_shown_when_decoded(std::vector<double> decoding, const std::vector<double>& times) {
  if (times.empty()) return false;
  std::erase_if(decoding, [&](double time) { return time < times.front() - same_time; });
  for (std::size_t i = 0; i < std::min(decoding.size(), times.size()); ++i)
    if (std::abs(decoding[i] - times[i]) > same_time) return false;
  return !decoding.empty();
}

/// What a packet says of its picture, s.
struct PicturePacket {
  std::optional<double> shown, decoded;
  bool is_key = false, is_hidden = false;
};

/// Of the video's packets, in the order of the file.
std::vector<PicturePacket> packets_of(const LoadedFormats& av, AVFormatContext* context,
                                      const AVStream& video) {
  const double unit = video.time_base.num / static_cast<double>(video.time_base.den);
  const std::int64_t begin = video.start_time == AV_NOPTS_VALUE ? 0 : video.start_time;
  const auto seconds = [&](std::int64_t time) {
    return time == AV_NOPTS_VALUE ? std::nullopt : std::optional(unit * static_cast<double>(time - begin));
  };
  std::vector<PicturePacket> packets;
  AVPacket* const packet = av.packet();
  while (packet != nullptr && av.read(context, packet) >= 0) {
    if (packet->stream_index == video.index && packet->size > 0)
      packets.push_back({seconds(packet->pts), seconds(packet->dts), (packet->flags & AV_PKT_FLAG_KEY) != 0,
                         (packet->flags & AV_PKT_FLAG_DISCARD) != 0});
    av.release(packet);
  }
  return packets;
}

/// Where decoding times go back, a stream begins again: what follows is shown after what came before.
void join_restarts(std::vector<PicturePacket>& packets) {
  double offset = 0.0, last = -HUGE_VAL, latest = -HUGE_VAL, gap = 0.0;
  for (PicturePacket& packet : packets) {
    if (!packet.decoded) continue;
    const double own = *packet.decoded;
    if (own + offset < last - same_time)
      offset = std::max(latest, last) + gap - packet.shown.value_or(own);
    else if (last > -HUGE_VAL)
      gap = own + offset - last;
    last = own + offset;
    *packet.decoded = last;
    if (!packet.shown) continue;
    *packet.shown += offset;
    latest = std::max(latest, *packet.shown);
  }
}

/// Takes out what no decoder can show, as the file begins within a group of pictures: those before the first
/// that stands for itself, and those behind it that are shown sooner. @return how many
std::size_t drop_leading(std::vector<PicturePacket>& packets) {
  const std::size_t all = packets.size();
  const auto key =
      std::find_if(packets.begin(), packets.end(), [](const PicturePacket& one) { return one.is_key; });
  if (key == packets.end()) return 0;
  packets.erase(packets.begin(), key);
  const auto next =
      std::find_if(packets.begin() + 1, packets.end(), [](const PicturePacket& one) { return one.is_key; });
  const std::optional<double> first = packets.front().shown;
  packets.erase(
      std::remove_if(packets.begin() + 1, next,
                     [&](const PicturePacket& one) { return first && one.shown && *one.shown < *first; }),
      next);
  return all - packets.size();
}

}  // namespace

VideoTimes read_video_times(const std::string& file) {
  const LoadedFormats av;
  AVFormatContext* context = nullptr;  // it and its packets last until the child ends
  if (av.open(&context, file.c_str(), nullptr, nullptr) < 0 || av.look(context, nullptr) < 0)
    throw std::runtime_error("it cannot be decoded");
  const auto last = context->streams + context->nb_streams;
  const auto found_stream = std::find_if(context->streams, last, [](const AVStream* one) {
    return one->codecpar->codec_type == AVMEDIA_TYPE_VIDEO;
  });
  if (found_stream == last) throw std::runtime_error("it holds no pictures");
  const AVStream& video = **found_stream;  // stays where it is when the list of streams grows
  std::vector<PicturePacket> packets = packets_of(av, context, video);
  const std::size_t all = packets.size();
  join_restarts(packets);
  double length = 0.0;
  for (const PicturePacket& packet : packets) length = std::max(length, packet.decoded.value_or(0.0));
  VideoTimes found;
  found.leading = drop_leading(packets);
  std::erase_if(packets, [](const PicturePacket& packet) { return packet.is_hidden; });
  found.shown = packets.size();
  std::vector<double> shown, decoded;
  for (const PicturePacket& packet : packets) {
    if (packet.shown) shown.push_back(*packet.shown);
    if (packet.decoded) decoded.push_back(*packet.decoded);
  }
  std::sort(shown.begin(), shown.end());
  std::sort(decoded.begin(), decoded.end());
  if (shown.size() == found.shown) {
    found.times = shown;
  } else if (decoded.size() == found.shown && !decoded.empty()) {
    for (const double time : decoded) found.times.push_back(time - decoded.front());
  }
  found.is_time_reported = is_shown_when_decoded(decoded, found.times);
  found.stated = static_cast<std::size_t>(std::max<std::int64_t>(video.nb_frames, 0));
  // An AVI of uneven times says how many places it has for pictures: it is whole when the last one is there.
  constexpr double whole = 0.9;
  const double unit = video.time_base.num / static_cast<double>(video.time_base.den);
  const double duration = video.duration == AV_NOPTS_VALUE ? 0.0 : unit * static_cast<double>(video.duration);
  found.is_cut =
      is_cut_video(file) ||
      (static_cast<double>(all) < whole * static_cast<double>(found.stated) && length < whole * duration);
  return found;
}

std::optional<double> PictureClock::next(double reported) {
  const std::vector<double>& times = video_.times;
  if (times.empty()) return static_cast<double>(number_++) / rate_;
  if (video_.is_time_reported && number_ == 0 && std::abs(reported - times[0]) > same_time)
    video_.is_time_reported = false;  // the decoder has another delay
  if (video_.is_time_reported && std::isfinite(reported)) {
    const auto at = std::lower_bound(times.begin(), times.end(), reported - same_time);
    if (at != times.end() && *at < reported + same_time)
      number_ = std::max(number_, static_cast<std::size_t>(at - times.begin()));
  }
  if (number_ >= times.size()) return std::nullopt;
  return times[number_++];
}

}  // namespace clearway
