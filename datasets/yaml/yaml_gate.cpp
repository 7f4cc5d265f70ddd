#include "datasets/yaml/yaml_gate.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr size_t deepest = 32;

[[noreturn]] void refuse(const std::string& name, const YAML::Mark& mark, const std::string& what) {
  throw std::invalid_argument(name + ", line " + std::to_string(mark.line + 1) + ", column " +
                              std::to_string(mark.column + 1) + ": " + what + ".");
}

/// Counts what a document would become, before it becomes anything.
class Counter : public YAML::EventHandler {
 public:
  Counter(const std::string& name, const YamlBounds& bounds) : name_(name), bounds_(bounds) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (!begins_.empty() && begins_.back().pos == mark.pos)  // yaml-cpp would stay here for ever
      refuse(name_, mark, "not valid YAML, expected the end of the file");
    begins_.push_back(mark);
    nodes_ = repeated_ = 0;
    sizes_.clear();
  }
  void OnDocumentEnd() override {
    if (nodes_ > nulls_) documents_ = begins_.size();
    nulls_ = 0;
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    leaf(mark, anchor);
    ++nulls_;
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    leaf(mark, anchor);
    last_scalar_ = mark;
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = sizes_.find(anchor);
    if (found == sizes_.end()) refuse(name_, mark, "expected an alias of what is complete before it");
    add(mark, found->second);
    repeated_ += found->second;
    if (repeated_ > bounds_.repeated)
      refuse(name_, mark,
             "expected aliases to repeat at most " + std::to_string(bounds_.repeated) +
                 " words, lists and maps in a file of this size");
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnMapEnd() override { end(); }

  const YAML::Mark& last_scalar() const { return last_scalar_; }

  /// Tools end each message that they print with "---": behind the last one is nothing.
  void require_one_document() const {
    if (documents_ > 1)
      refuse(
          name_, begins_[1],
          "expected one document, got " + std::to_string(documents_) + ", of which the second begins here");
  }

 private:
  void add(const YAML::Mark& mark, size_t nodes) {
    nodes_ += nodes;
    if (nodes_ > bounds_.nodes)
      refuse(name_, mark,
             "expected at most " + std::to_string(bounds_.nodes) +
                 " words, lists and maps in a file of this size, repeated ones included" + bounds_.advice);
  }
  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    add(mark, 1);
    if (anchor != 0) sizes_[anchor] = 1;
  }
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() >= deepest) refuse(name_, mark, "expected at most 32 lists and maps inside each other");
    open_.emplace_back(anchor, nodes_);
    add(mark, 1);
  }
  void end() {
    const auto [anchor, before] = open_.back();
    open_.pop_back();
    if (anchor != 0) sizes_[anchor] = nodes_ - before;
  }

  const std::string& name_;
  const YamlBounds bounds_;  ///< of this file
  size_t nodes_ = 0, repeated_ = 0, nulls_ = 0;
  size_t documents_ = 0;  ///< up to the last one that holds something
  YAML::Mark last_scalar_;
  std::vector<YAML::Mark> begins_;  ///< of all documents
  std::vector<std::pair<YAML::anchor_t, size_t>> open_;
  std::map<YAML::anchor_t, size_t> sizes_;  ///< of what is complete
};

/// yaml-cpp's words for the common mistakes, and ours.
constexpr std::array<std::pair<std::string_view, const char*>, 11> mistakes = {
    {{"illegal EOF in scalar", "expected a quoted text to end"},
     {"illegal document indicator in scalar", "expected a quoted text to end before '---'"},
     {"end of map not found", "expected the next key of the same map, as far to the right as the one before"},
     {"end of map flow not found", "expected ',' or '}'"},
     {"end of sequence not found", "expected the next '-' of the same list"},
     {"end of sequence flow not found", "expected ',' or ']'"},
     {"illegal map value", "expected no second ': ' in a value without quotes"},
     {"illegal block entry", "expected no list here: '-' begins one on a line of its own"},
     {"illegal flow end", "expected no ']' or '}' here"},
     {"the referenced anchor is not defined", "expected an alias of what is named before it"},
     {"block entry", "expected a value before the next '-'"}}};

std::string expected(const std::string& message) {
  for (const auto& [theirs, ours] : mistakes)
    if (std::string_view(message).starts_with(theirs)) return std::string("not valid YAML, ") + ours;
  return "not valid YAML, expected keys and values, lists or texts";
}

void read_all(const std::string& text, Counter& counter) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  while (parser.HandleNextDocument(counter)) {
  }
}

/// yaml-cpp ends a quoted text with the file, but refuses a line of "---" in it.
bool ends_in_quotes(const std::string& text, Counter counter) {
  try {
    read_all(text + "\n---\n", counter);
    return false;
  } catch (const YAML::Exception&) {
    return true;
  }
}

}  // namespace

void require_yaml(const std::string& text, const std::string& name, const YamlBounds& bounds) {
  // yaml-cpp takes some 500 bytes for each: by default 150 MB and twenty times the file at most.
  const size_t by_size = text.size() / 32;
  const YamlBounds of_file{bounds.nodes + by_size, bounds.repeated + by_size, bounds.advice};
  Counter counter(name, of_file);
  try {
    read_all(text, counter);
    counter.require_one_document();
    if (ends_in_quotes(text, Counter(name, of_file)))
      refuse(name, counter.last_scalar(), "not valid YAML, expected this quoted text to end");
  } catch (const YAML::Exception& error) {
    refuse(name, error.mark, expected(error.msg));
  }
}

std::string read_text(const std::filesystem::path& file, const std::string& what) {
  return read_input(file, what, 4U << 20U);
}

}  // namespace clearway
