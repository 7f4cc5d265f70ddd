#include "datasets/pictures/files_in_child.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "datasets/sources/frame_bytes.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t largest_file = 256U << 20U;
constexpr std::uint64_t decoder_memory = 256U << 20U;  ///< for 64 million pixels and what the decoder needs

/// What reads each file, in the child.
void decode_files(const ChildReport& report, const std::vector<std::filesystem::path>& files,
                  std::size_t from, const std::string& what, const FilesInChild::Decode& decode) {
  for (std::size_t i = from; i < files.size(); ++i) {
    const std::string name = what + " " + quote_path(files[i].string()) + " is damaged: ";
    try {
      DecodedFrame frame;
      frame.frame.content = decode(read_input(files[i], what, largest_file), i);
      report.send(ChildMessage::frame, i, frame_to_bytes(frame));
    } catch (const std::invalid_argument& error) {  // not readable: a whole sentence
      report.send(ChildMessage::skipped, i, error.what());
    } catch (const std::bad_alloc&) {
      report.send(ChildMessage::skipped, i, name + "it asks for more memory than it may take");
    } catch (const std::exception& error) {
      report.send(ChildMessage::skipped, i, name + error.what());
    }
  }
  report.send(ChildMessage::end, 0, "");
}

}  // namespace

FilesInChild::FilesInChild(std::vector<std::filesystem::path> files, std::string what, Decode decode)
    : files_(std::move(files)), what_(std::move(what)), decode_(std::move(decode)) {
  if (!files_.empty()) start();
}

void FilesInChild::start() {
  std::uint64_t largest = 0, all = 0;
  for (std::size_t i = at_; i < files_.size(); ++i) {
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(files_[i], error);
    if (error) continue;
    largest = std::max<std::uint64_t>(largest, std::min<std::uint64_t>(size, largest_file));
    all += size;
  }
  const DecodingLimits limits{.memory = decoder_memory + 20 * largest,
                              .seconds = DecodingLimits::of_file(all).seconds};
  child_ = std::make_unique<DecodingChild>(limits, -1, [this](const ChildReport& report, int) {
    decode_files(report, files_, at_, what_, decode_);
  });
}

std::optional<FilesInChild::Outcome> FilesInChild::next() {
  if (at_ >= files_.size()) return std::nullopt;
  if (!child_) start();
  Outcome outcome{files_[at_], std::nullopt, ""};
  const std::string name = what_ + " " + quote_path(outcome.file.string()) + " is damaged: ";
  ChildMessage message = child_->receive();
  ++at_;
  if (message.kind == ChildMessage::frame) {
    try {
      outcome.content = std::move(frame_from_bytes(message.text).frame.content);
    } catch (const std::runtime_error& error) {
      outcome.refusal = name + error.what();
      child_.reset();
    }
  } else if (message.kind == ChildMessage::skipped) {
    outcome.refusal = message.text;
  } else {
    outcome.refusal = name + "decoding it does not come to an end, or crashes the decoder";
    child_.reset();
  }
  return outcome;
}

}  // namespace clearway
