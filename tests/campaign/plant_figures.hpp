// The figures of a row of the campaign over plants.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

namespace cargobay::campaign {

// One value a plant.
struct Figures {
  std::vector<double> values{};

  void add(double value) { values.push_back(value); }
  // The quantile; 0 if there are none.
  double at(double share) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(share * last))];
  }
};

inline double mean(const Figures& figures) {
  const double sum = std::accumulate(figures.values.begin(), figures.values.end(), 0.0);
  return figures.values.empty() ? 0.0 : sum / static_cast<double>(figures.values.size());
}

// p50, p95, p99.
inline std::string shares(Figures& figures) {
  char text[80];
  std::snprintf(text, sizeof text, "%.2f, %.2f, %.2f", figures.at(0.5), figures.at(0.95),
                figures.at(0.99));
  return text;
}

}  // namespace cargobay::campaign
