#include "tests/network/link.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace coppice::test {

namespace {

struct Unit {
  std::string_view name;
  double factor;
};

constexpr Unit shares[] = {{"%", 0.01}};
constexpr Unit times[] = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}};
constexpr Unit rates[] = {{"bit", 1}, {"kbit", 1e3}, {"mbit", 1e6}, {"gbit", 1e9}};
constexpr Unit counts[] = {{"", 1}};

/// A non-negative number with one of the units; nothing otherwise.
std::optional<double> quantity(const std::string& word, std::span<const Unit> units) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || !(value >= 0) || std::isinf(value)) return std::nullopt;
  const std::string_view rest(end, static_cast<std::size_t>(word.data() + word.size() - end));
  const auto unit = std::ranges::find(units, rest, &Unit::name);
  if (unit == units.end()) return std::nullopt;
  return value * unit->factor;
}

class Words {
 public:
  explicit Words(std::string_view text) : in_(std::string(text)) { next(); }
  bool end() const { return word_.empty(); }
  std::string take() {
    std::string word = std::move(word_);
    next();
    return word;
  }
  double take(std::span<const Unit> units, const std::string& of) {
    const auto value = quantity(word_, units);
    if (!value) throw std::invalid_argument("\"" + word_ + "\" after " + of);
    next();
    return *value;
  }
  double take_share(const std::string& of) {
    const double share = take(shares, of);
    if (share > 1) throw std::invalid_argument(of + " above 100%");
    return share;
  }
  bool is_quantity(std::span<const Unit> units) const { return quantity(word_, units).has_value(); }

 private:
  void next() {
    word_.clear();
    in_ >> word_;
  }
  std::istringstream in_;
  std::string word_;
};

bool take_switch(Words& words, const std::string& of) {
  const std::string word = words.take();
  if (word != "on" && word != "off") throw std::invalid_argument("\"" + word + "\" after " + of);
  return word == "on";
}

}  // namespace

LinkRule parse_link_rule(std::string_view text) {
  LinkRule rule;
  for (Words words(text); !words.end();) {
    const std::string key = words.take();
    if (key == "loss") {
      rule.loss = words.take_share(key);
    } else if (key == "duplicate") {
      rule.duplicate = words.take_share(key);
    } else if (key == "delay") {
      rule.delay = words.take(times, key);
      if (words.is_quantity(times)) rule.jitter = words.take(times, key);
    } else if (key == "rate") {
      rule.rate = words.take(rates, key);
    } else if (key == "limit") {
      rule.limit = static_cast<std::size_t>(words.take(counts, key));
    } else if (key == "multicast") {
      rule.multicast = take_switch(words, key);
    } else if (key == "down") {
      rule.down = true;
    } else {
      throw std::invalid_argument("\"" + key + "\" is no rule of a link");
    }
  }
  return rule;
}

bool is_multicast(const unsigned char* frame, std::size_t size) {
  constexpr std::size_t header = 14;
  if (size < header || (frame[0] & 1) == 0) return false;
  const bool is_broadcast = std::all_of(frame, frame + 6, [](unsigned char byte) { return byte == 0xff; });
  const bool is_ipv6 = frame[12] == 0x86 && frame[13] == 0xdd;
  constexpr std::size_t next_header = header + 6;
  constexpr std::size_t icmp_type = header + 40;
  const bool finds_neighbours = is_ipv6 && size > icmp_type && frame[next_header] == 58 &&
                                frame[icmp_type] >= 133 && frame[icmp_type] <= 137;
  return !is_broadcast && !finds_neighbours;
}

std::vector<double> Link::pass(std::size_t size, bool multicast, double now, std::mt19937_64& random) {
  ++counts_.came;
  if (multicast && !rule.multicast) {
    ++counts_.multicast;
    return {};
  }
  std::uniform_real_distribution<double> share(0, 1);
  // Both are drawn for every frame, so that the chance of one rule does not depend on another.
  const bool is_lost = share(random) < rule.loss;
  const bool is_doubled = share(random) < rule.duplicate;
  if (is_lost || rule.down) {
    ++counts_.lost;
    return {};
  }
  counts_.doubled += is_doubled;
  std::vector<double> out;
  for (int copy = 0; copy < (is_doubled ? 2 : 1); ++copy) {
    if (under_way_ >= rule.limit) {
      ++counts_.over_limit;
      continue;
    }
    ++under_way_;
    out.push_back(due(size, now, random));
  }
  return out;
}

double Link::due(std::size_t size, double now, std::mt19937_64& random) {
  std::uniform_real_distribution<double> around(-1, 1);
  const double delay = std::max(0.0, rule.delay + rule.jitter * around(random));
  if (rule.rate > 0) {
    busy_until_ = std::max(now, busy_until_) + 8.0 * static_cast<double>(size) / rule.rate;
    return busy_until_ + delay;
  }
  return now + delay;
}

}  // namespace coppice::test
