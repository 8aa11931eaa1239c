// Draws the sensor model: signal, SNR and sigma over incidence for three finishes, and over the working
// range.
//
//   build/release/bench/sim_sensor_model > docs/sensor_model.svg
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "sim/sensor_model.h"

namespace {

using namespace trueblade;

struct Curve {
  std::string name, colour;
  std::function<double(double)> value;
};

// One diagram: curves over x in [low, high], y from 0 to top.
void draw(double left, const std::string& title, const std::string& x_label, double low, double high,
          double top, const std::vector<Curve>& curves) {
  constexpr double kTop = 40, kWidth = 300, kHeight = 220;
  const auto px = [&](double x) { return left + kWidth * (x - low) / (high - low); };
  const auto py = [&](double y) { return kTop + kHeight * (1.0 - std::min(y, top) / top); };
  fmt::print("<text x=\"{}\" y=\"26\" font-size=\"13\">{}</text>\n", left, title);
  fmt::print("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n", left,
             kTop, kWidth, kHeight);
  for (int k = 0; k <= 4; ++k) {
    const double y = top * k / 4, x = low + (high - low) * k / 4;
    fmt::print("<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>\n", left,
               left + kWidth, py(y));
    fmt::print("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.3g}</text>\n", left - 4, py(y) + 4, y);
    fmt::print("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.3g}</text>\n", px(x),
               kTop + kHeight + 14, x);
  }
  fmt::print("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", left + kWidth / 2,
             kTop + kHeight + 30, x_label);
  double key = kTop + 14;
  for (const Curve& curve : curves) {
    std::string points;
    for (int k = 0; k <= 300; ++k) {
      const double x = low + (high - low) * k / 300;
      const double y = curve.value(x);
      if (y <= top) points += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
    }
    fmt::print("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", points,
               curve.colour);
    fmt::print("<text x=\"{}\" y=\"{}\" fill=\"{}\" text-anchor=\"end\">{}</text>\n", left + kWidth - 6, key,
               curve.colour, curve.name);
    key += 14;
  }
}

}  // namespace

int main() {
  const Lens lens = standard_lens("25mm");
  constexpr double kDegree = std::numbers::pi / 180.0;
  struct Finish {
    const char *name, *colour;
    SensorModel model;
  };
  std::vector<Finish> finishes{
      {"matt", "#2a7f3f", {}}, {"ground", "#3355bb", {}}, {"polished", "#cc4433", {}}};
  finishes[0].model.finish = matt_finish();
  finishes[1].model.finish = ground_finish();
  finishes[2].model.finish = polished_finish();

  fmt::print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1480\" height=\"310\" font-family=\"sans-serif\" "
      "font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
  std::vector<Curve> signal, snr, sigma;
  for (const Finish& f : finishes) {
    const SensorModel model = f.model;
    const auto at = [=](double degrees) {
      return mean_signal(model, lens, 0.0, std::cos(degrees * kDegree));
    };
    signal.push_back({f.name, f.colour, at});
    snr.push_back({f.name, f.colour, [=](double degrees) { return signal_to_noise(model, at(degrees)); }});
    sigma.push_back({f.name, f.colour, [=](double degrees) {
                       return 1000.0 *
                              distance_sigma_mm(model, lens, at(degrees), std::cos(degrees * kDegree));
                     }});
  }
  draw(50, "signal", "incidence, degrees", 0, 75, 1, signal);
  draw(410, "SNR", "incidence, degrees", 0, 75, 1, snr);
  draw(770, "sigma of the distance, um (25 mm lens)", "incidence, degrees", 0, 75, 40, sigma);
  const SensorModel matt = finishes[0].model;
  draw(1130, "sigma over the working range, um (matt)", "range less standoff, mm", -0.35, 0.35, 8,
       {{"0 degrees", "#2a7f3f",
         [=](double offset) {
           return 1000.0 * distance_sigma_mm(matt, lens, mean_signal(matt, lens, offset, 1.0), 1.0);
         }},
        {"45 degrees", "#3355bb", [=](double offset) {
           const double cosine = std::cos(45.0 * kDegree);
           return 1000.0 * distance_sigma_mm(matt, lens, mean_signal(matt, lens, offset, cosine), cosine);
         }}});
  fmt::print("</svg>\n");
  return 0;
}
