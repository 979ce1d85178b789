#include "tools/batch/time_estimate.h"

#include <cmath>

namespace spool::tools {
namespace {

double finite_or_zero(double value) {
  return std::isfinite(value) ? value : 0.0;
}

}  // namespace

TimeEstimate::TimeEstimate(const std::vector<Cell>& cells,
                           const std::function<double(const std::string&)>& pixels) {
  for (const Cell& cell : cells) {
    const auto [place, fresh] = pixels_of_.try_emplace(cell.dump, 0.0);
    if (fresh) place->second = pixels(cell.dump);
    const double n = place->second;
    if (runs_left_.insert(sampling_key(cell)).second)
      sampling_all_[cell.sampler.label()] += n * cell.spp;
    filtering_all_[cell.filter.label()] += n;
    pixels_all_ += n;
  }
  sampling_left_ = sampling_all_;
  filtering_left_ = filtering_all_;
  pixels_left_ = pixels_all_;
}

void TimeEstimate::learn(const Cell& cell, const ResultRecord& record) {
  const double pixels = record.number("width") * record.number("height");
  if (!(pixels > 0.0)) return;
  ++learnt_;
  if (std::string run = sampling_key(cell); run != learnt_run_) {
    Rate& rate = sampling_rates_[cell.sampler.label()];
    rate.work += pixels * cell.spp;
    rate.seconds += finite_or_zero(record.number("seconds_sampling"));
    learnt_run_ = std::move(run);
  }
  Rate& rate = filtering_rates_[cell.filter.label()];
  rate.work += pixels;
  rate.seconds += finite_or_zero(record.number("seconds_filtering"));
  rest_.work += pixels;
  rest_.seconds += finite_or_zero(record.number("seconds_judging")) +
                   finite_or_zero(record.number("seconds_writing"));
}

void TimeEstimate::finished(const Cell& cell) {
  const double pixels = pixels_of_[cell.dump];
  if (runs_left_.erase(sampling_key(cell)) > 0) {
    sampling_left_[cell.sampler.label()] -= pixels * cell.spp;
  }
  filtering_left_[cell.filter.label()] -= pixels;
  pixels_left_ -= pixels;
}

double TimeEstimate::predict(const std::map<std::string, double>& work, const Rates& rates) {
  Rate mean;
  for (const auto& [label, rate] : rates) {
    mean.work += rate.work;
    mean.seconds += rate.seconds;
  }
  double seconds = 0.0;
  for (const auto& [label, amount] : work) {
    const auto found = rates.find(label);
    const Rate& rate = found == rates.end() ? mean : found->second;
    if (rate.work > 0.0) seconds += amount * rate.seconds / rate.work;
  }
  return seconds;
}

double TimeEstimate::expected(const std::map<std::string, double>& sampling,
                              const std::map<std::string, double>& filtering, double pixels) const {
  const double rest = rest_.work > 0.0 ? pixels * rest_.seconds / rest_.work : 0.0;
  return predict(sampling, sampling_rates_) + predict(filtering, filtering_rates_) + rest;
}

double TimeEstimate::seconds_left() const {
  return expected(sampling_left_, filtering_left_, pixels_left_);
}

double TimeEstimate::share_done() const {
  const double all = expected(sampling_all_, filtering_all_, pixels_all_);
  return all > 0.0 ? 1.0 - seconds_left() / all : 0.0;
}

}  // namespace spool::tools
