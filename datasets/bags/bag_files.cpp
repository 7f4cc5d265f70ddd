#include "datasets/bags/bag_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>
#include <string_view>

#include "datasets/bags/bag_source.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::unique_ptr<MessageBag> open_messages(const std::filesystem::path& file, int descriptor,
                                          std::uint64_t size) {
  char magic[7] = {};
  const bool has_magic = ::pread(descriptor, magic, 6, 0) == 6;
  if (has_magic && std::string_view(magic).starts_with("#R")) return open_ros1_bag(file);
  const bool is_mcap = has_magic && std::string_view(magic).starts_with("\x89MCAP");
  const bool is_sqlite = has_magic && std::string_view(magic) == "SQLite";
  return is_sqlite || (is_sqlite_bag(file) && !is_mcap) ? open_sqlite_bag(file) : open_mcap(descriptor, size);
}

/// The name without what says that the file is packed.
std::string unpacked_name(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return (kind == ".zstd" || kind == ".zst" ? file.stem() : file.filename()).string();
}

/// The files of a folder with this end of their names, in the order of names, numbers by value. Of a part of
/// SQLite that lies there packed and unpacked, the unpacked one.
std::vector<std::filesystem::path> files_with(const std::filesystem::path& folder, const std::string& kind) {
  std::map<std::string, std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path& file = entry.path();
    if (extension_of(file) == kind || (kind == ".bag" && is_ros1_bag(file)))
      files[file.filename().string()] = file;
    if (kind == ".db3" && is_sqlite_bag(file)) files.try_emplace(unpacked_name(file), file);
  }
  std::vector<std::filesystem::path> list;
  for (const auto& [name, file] : files) list.push_back(file);
  return in_order_of_names(list);
}

/// Several bags, one after the other in the order of their first messages, as one. In the child.
class JoinedBag final : public MessageBag {
 public:
  explicit JoinedBag(const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) add(file);
    if (parts_.empty()) throw std::runtime_error(damage_);
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const Part& a, const Part& b) { return a.bag->first_time() < b.bag->first_time(); });
  }

  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    visit_parts(&MessageBag::visit, wanted, take);
  }
  void visit_by_index(const std::vector<bool>& wanted,
                      const std::function<bool(const BagMessage&)>& take) override {
    visit_parts(&MessageBag::visit_by_index, wanted, take);
  }
  /// Where each of the parts has an index.
  std::optional<std::vector<TopicSpan>> spans() const override {
    std::vector<TopicSpan> spans(topics_.size());
    for (const Part& part : parts_) {
      const auto of_part = part.bag->spans();
      if (!of_part) return std::nullopt;
      for (std::size_t i = 0; i < of_part->size(); ++i) spans[part.topics[i]].add((*of_part)[i]);
    }
    return spans;
  }
  std::optional<double> first_time() const override {
    for (const Part& part : parts_)  // one without messages comes first
      if (const auto time = part.bag->first_time()) return time;
    return std::nullopt;
  }
  std::uint64_t offset() const override {
    return done_ + (at_ < parts_.size() ? parts_[at_].bag->offset() : 0);
  }

 private:
  struct Part {
    std::string name;
    std::unique_ptr<InputFile> input;
    std::unique_ptr<MessageBag> bag;
    std::vector<std::size_t> topics;  ///< numbers of its topics here
    std::size_t number = 0;           ///< in the order of names
  };

  using Visit = void (MessageBag::*)(const std::vector<bool>&, const std::function<bool(const BagMessage&)>&);
  void visit_parts(Visit visit, const std::vector<bool>& wanted,
                   const std::function<bool(const BagMessage&)>& take) {
    done_ = 0;
    bool goes_on = true;
    for (at_ = 0; at_ < parts_.size() && goes_on; ++at_) {
      const Part& part = parts_[at_];
      std::vector<bool> of_part;
      for (const std::size_t topic : part.topics) of_part.push_back(wanted[topic]);
      (*part.bag.*visit)(of_part, [&](BagMessage message) {
        message.topic = part.topics[message.topic];
        message.place.part = part.number;
        return goes_on = take(message);
      });
      note_damage(part);
      done_ += part.input->size();
    }
  }

  void add(const std::filesystem::path& file) {
    Part part{quote_path(file.filename().string()), std::make_unique<InputFile>(file, "bag"), nullptr, {}};
    part.number = number_++;
    try {
      part.bag = open_messages(file, part.input->descriptor(), part.input->size());
    } catch (const std::runtime_error& error) {
      if (damage_.empty()) damage_ = "of its " + part.name + ": " + error.what();
      return;  // as one that is not there
    }
    for (const BagTopic& topic : part.bag->topics()) part.topics.push_back(number_of(topic));
    note_damage(part);
    parts_.push_back(std::move(part));
  }
  std::size_t number_of(const BagTopic& topic) {
    const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
      return known.name == topic.name && known.type == topic.type && known.wire == topic.wire;
    });
    if (found == topics_.end()) {
      topics_.push_back(topic);
      return topics_.size() - 1;
    }
    found->count += topic.count;
    return static_cast<std::size_t>(found - topics_.begin());
  }
  void note_damage(const Part& part) {
    if (damage_.empty() && !part.bag->damage().empty())
      damage_ = "of its " + part.name + ": " + part.bag->damage();
  }

  std::vector<Part> parts_;
  std::size_t number_ = 0, at_ = 0;
  std::uint64_t done_ = 0;  ///< bytes of the parts before
};

}  // namespace

BagFiles::BagFiles(const std::filesystem::path& bag) : files_{bag} {
  if (is_packed_mcap(bag))
    throw std::invalid_argument(bag_sentence(bag, "is packed as a whole: expected it unpacked (`zstd -d`)"));
  const bool is_folder = is_bag_folder(bag);
  if (is_folder) files_ = files_with(bag, ".mcap");
  if (is_folder && files_.empty()) files_ = files_with(bag, ".db3");
  if (is_folder && files_.empty()) files_ = files_with(bag, ".bag");
  if (is_folder && extension_of(files_.front()) == ".mcap" && !files_with(bag, ".db3").empty())
    throw std::invalid_argument(bag_sentence(
        bag, "has MCAP files and SQLite's (.db3): expected one kind, or one of them by its name"));
  for (const std::filesystem::path& file : files_) {
    inputs_.push_back(std::make_unique<InputFile>(file, "bag"));
    size_ += inputs_.back()->size();
  }
  if (size_ == 0 && !is_sqlite_bag(files_.front()))  // of one, all may lie in its log
    throw std::invalid_argument(bag_sentence(bag, "is empty: it has 0 bytes"));
}

std::string BagFiles::missing(const std::vector<std::string>& parts) const {
  std::string first;
  std::size_t count = 0;
  for (const std::string& part : parts) {
    const bool is_read = std::any_of(files_.begin(), files_.end(), [&](const auto& file) {
      return unpacked_name(file) == unpacked_name(part);
    });
    if (!is_read && count++ == 0) first = quote(part);
  }
  if (count == 0) return "";
  return "its metadata.yaml lists " + first + ", which is not there" +
         (count > 1 ? ", nor are " + std::to_string(count - 1) + " more" : "") + " as a bag";
}

std::unique_ptr<MessageBag> BagFiles::open(int descriptor) const {
  if (files_.size() > 1) return std::make_unique<JoinedBag>(files_);
  return open_messages(files_.front(), descriptor, size_);
}

std::string bag_sentence(const std::filesystem::path& file, const std::string& clause) {
  return "bag " + quote_path(file.string()) + " " + clause;
}

}  // namespace clearway
