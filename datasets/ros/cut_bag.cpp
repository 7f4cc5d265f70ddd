#include "datasets/ros/cut_bag.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr double margin = 2.0;  ///< s: longest gap between two poses, and as much that one may come late

class CutBag final : public MessageBag {
 public:
  CutBag(std::unique_ptr<MessageBag> bag, const BagTopics& part)
      : bag_(std::move(bag)), from_(part.from), to_(part.to), poses_(part.poses) {
    topics_ = bag_->topics();
    damage_ = bag_->damage();
  }

  void visit(const std::vector<bool>& topics, const std::function<bool(const BagMessage&)>& take) override {
    const double first = bag_->first_time().value_or(0.0);
    bag_->visit(topics, [&](BagMessage message) {
      const BagTopic& topic = topics_[message.topic];
      const double since = message.time - first;
      const bool is_in = since >= from_ && (!to_ || since < *to_);
      const bool is_pose =
          is_transforms(topic) || std::find(poses_.begin(), poses_.end(), topic.name) != poses_.end();
      if (!is_pose) visited_.add(since);
      has_some_ = has_some_ || (is_in && !is_pose);
      if (is_in || topic.name.ends_with("tf_static")) return take(message);
      message.is_beyond = since >= from_ - margin && (!to_ || since < *to_ + margin);
      return message.is_beyond && is_pose ? take(message) : true;
    });
    damage_ = bag_->damage();
  }
  std::optional<double> first_time() const override { return bag_->first_time(); }
  std::uint64_t offset() const override { return bag_->offset(); }
  std::string why_none() const override {
    if (has_some_ || visited_.last < visited_.first) return "";
    const std::string part =
        "from " + short_text(from_, 6) + " s" + (to_ ? " to " + short_text(*to_, 6) + " s" : " on");
    return "has no message of these topics " + part + " (`from` and `to` of the setup); theirs go from " +
           short_text(visited_.first, 6) + " to " + short_text(visited_.last, 6) + " s";
  }

 private:
  std::unique_ptr<MessageBag> bag_;
  double from_;
  std::optional<double> to_;
  std::vector<std::string> poses_;
  TopicSpan visited_;  ///< s after the first message, of all but poses
  bool has_some_ = false;
};

}  // namespace

std::unique_ptr<MessageBag> cut_bag(std::unique_ptr<MessageBag> bag, const BagTopics& topics) {
  if (topics.from == 0.0 && !topics.to) return bag;
  return std::make_unique<CutBag>(std::move(bag), topics);
}

std::optional<double> cut_before(std::span<const double> recorded, std::size_t restart, double first) {
  const auto at = recorded.begin() + static_cast<std::ptrdiff_t>(restart);
  const double last = *std::max_element(recorded.begin(), at), next = *std::min_element(at, recorded.end());
  if (!(last < next)) return std::nullopt;
  for (const double step : {0.1, 0.01, 0.001, 1e-4}) {
    const double cut = step * std::floor((next - first) / step);
    if (cut > last - first && cut > 0.0) return cut;
  }
  return std::nullopt;
}

}  // namespace clearway
