#include "exemplars/rover/particle_filter.h"

#include <algorithm>
#include <numeric>

namespace culprit::rover {
namespace {

constexpr std::size_t kParticles = 200;
constexpr double kShortest = 0.05;  // metres: nearer is no beam, and NaN is none
constexpr double kFar = 0.5;   // metres: a beam that ends that far from a wall is as bad as any
constexpr double kHit = 0.15;  // metres: standard deviation of a beam
constexpr double kNear = 0.2;  // metres: such a beam fits

}  // namespace

ParticleFilter::ParticleFilter(const GridMap& map, std::uint64_t seed)
    : map_(map), distances_(map.distances(kFar)), random_(seed) {
  place({});
}

void ParticleFilter::place(const Pose2& near) {
  particles_.clear();
  for (std::size_t i = 0; i < kParticles; ++i) {
    particles_.push_back({near.x + 0.1 * noise(random_), near.y + 0.1 * noise(random_),
                          normalized(near.yaw + 0.1 * noise(random_))});
  }
  estimate_ = {near, 0.01, 0.01, 1};
}

std::optional<double> ParticleFilter::off(const Pose2& pose, const Scan& scan, int beam) const {
  const auto beams = static_cast<int>(scan.ranges.size());
  const auto range = static_cast<double>(scan.ranges[static_cast<std::size_t>(beam)]);
  if (!(range > kShortest && range < scan.longest)) return std::nullopt;
  const double angle = pose.yaw - std::numbers::pi + 2 * std::numbers::pi * beam / beams;
  const int column = GridMap::cell(pose.x + range * std::cos(angle));
  const int row = GridMap::cell(pose.y + range * std::sin(angle));
  const bool is_inside = column >= 0 && row >= 0 && column < map_.width() && row < map_.height();
  return is_inside ? static_cast<double>(distances_[map_.index(column, row)]) : kFar;
}

// Its logarithm, a beam: the sum over the beams would be far too sure, for they are not independent.
double ParticleFilter::likelihood(const Pose2& pose, const Scan& scan, int every) const {
  if (map_.is_wall_at(pose.x, pose.y)) return -100;
  double sum = 0;
  int count = 0;
  for (int i = 0; i < static_cast<int>(scan.ranges.size()); i += every) {
    const auto miss = off(pose, scan, i);
    if (!miss) continue;
    sum -= *miss * *miss / (2 * kHit * kHit);
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

void ParticleFilter::place_anywhere(const Scan& scan) {
  constexpr int kEvery = 2;  // cells
  constexpr int kYaws = 48;
  std::vector<std::pair<double, Pose2>> all;
  for (int row = 0; row < map_.height(); row += kEvery) {
    for (int column = 0; column < map_.width(); column += kEvery) {
      if (map_.is_wall(column, row)) continue;
      for (int i = 0; i < kYaws; ++i) {
        const Pose2 pose{GridMap::centre(column), GridMap::centre(row),
                         normalized(2 * std::numbers::pi * i / kYaws)};
        all.emplace_back(likelihood(pose, scan, 4), pose);
      }
    }
  }
  const auto is_better = [](const auto& a, const auto& b) { return a.first > b.first; };
  const std::size_t kept = std::min(kParticles, all.size());
  std::ranges::partial_sort(all, all.begin() + static_cast<std::ptrdiff_t>(kept), is_better);
  all.resize(kept);
  for (auto& [value, pose] : all) value = likelihood(pose, scan, 1);
  std::ranges::sort(all, is_better);
  if (!all.empty()) place(all.front().second);
  summarize(scan);
}

void ParticleFilter::update(const Pose2& motion, const Scan& scan) {
  const bool is_blind = std::ranges::none_of(scan.ranges, [&](float range) {
    return static_cast<double>(range) > kShortest && static_cast<double>(range) < scan.longest;
  });
  if (is_blind) return;
  const double driven = std::hypot(motion.x, motion.y);
  weights_.clear();
  for (Pose2& particle : particles_) {
    particle = particle * Pose2{motion.x + (0.01 + 0.1 * driven) * noise(random_),
                                motion.y + (0.01 + 0.1 * driven) * noise(random_),
                                motion.yaw + (0.01 + 0.1 * std::abs(motion.yaw)) * noise(random_)};
    weights_.push_back(std::exp(10 * likelihood(particle, scan, 3)));
  }
  resample();
  summarize(scan);
}

void ParticleFilter::resample() {
  const double total = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  if (total <= 0) return;
  std::vector<Pose2> drawn;
  const double step = total / static_cast<double>(kParticles);
  double next = step * static_cast<double>(random_() >> 11) * 0x1p-53;
  double sum = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    for (sum += weights_[i]; next < sum && drawn.size() < kParticles; next += step)
      drawn.push_back(particles_[i]);
  }
  while (drawn.size() < kParticles) drawn.push_back(particles_.back());
  particles_ = std::move(drawn);
}

void ParticleFilter::summarize(const Scan& scan) {
  double x = 0;
  double y = 0;
  double sine = 0;
  double cosine = 0;
  for (const Pose2& each : particles_) {
    x += each.x;
    y += each.y;
    sine += std::sin(each.yaw);
    cosine += std::cos(each.yaw);
  }
  const auto count = static_cast<double>(particles_.size());
  estimate_ = {{x / count, y / count, std::atan2(sine, cosine)}, 0, 0, 0};
  for (const Pose2& each : particles_) {
    estimate_.variance_x += std::pow(each.x - estimate_.pose.x, 2) / count;
    estimate_.variance_y += std::pow(each.y - estimate_.pose.y, 2) / count;
  }
  int hits = 0;
  int fits = 0;
  for (int i = 0; i < static_cast<int>(scan.ranges.size()); ++i) {
    const auto miss = off(estimate_.pose, scan, i);
    hits += miss ? 1 : 0;
    fits += miss && *miss < kNear ? 1 : 0;
  }
  estimate_.match = hits == 0 ? 0 : static_cast<double>(fits) / hits;
}

}  // namespace culprit::rover
