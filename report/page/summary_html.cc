// SPDX-License-Identifier: Apache-2.0
#include "report/page/summary_html.h"

#include <fmt/core.h>

#include <cmath>
#include <string_view>

#include "base/text/escape.h"
#include "base/units.h"
#include "eval/statistics/text_table.h"
#include "report/page/html_parts.h"

namespace sextant {
namespace {

struct ToneLook {
  std::string_view kind;
  std::string_view mark;
};

ToneLook LookOf(PageTone tone) {
  switch (tone) {
    case PageTone::kGood:
      return {"good", "✓"};
    case PageTone::kCaution:
      return {"caution", "!"};
    case PageTone::kBad:
      return {"bad", "✕"};
    default:
      return {"neutral", "?"};
  }
}

std::string VerdictHtml(const PageVerdict& verdict) {
  const ToneLook look = LookOf(verdict.tone);
  std::string html = fmt::format(
      "<div class=\"verdict {}\" role=\"status\"><span class=\"mark\" aria-hidden=\"true\">{}"
      "</span><div><strong>{}</strong>\n",
      look.kind, look.mark, HtmlText(verdict.word));
  if (!verdict.reason.empty()) html += fmt::format("<p>{}.</p>\n", HtmlText(verdict.reason));
  if (!verdict.next.empty()) {
    html += fmt::format("<p><b>What to do:</b> {}.</p>\n", HtmlText(verdict.next));
  }
  return html + "</div></div>\n";
}

std::string MatrixText(const Rigid3d& pose) {
  const Eigen::Matrix4d matrix = pose.Matrix();
  std::string text;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += fmt::format("{:>13}{}", Fixed(matrix(row, column), 8), column < 3 ? " " : "\n");
    }
  }
  return text;
}

// Yaw, pitch, roll of Rz Ry Rx [deg].
Eigen::Vector3d EulerOf(const Rigid3d& pose) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  return kDegPerRad * Eigen::Vector3d(std::atan2(r(1, 0), r(0, 0)),
                                      std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))),
                                      std::atan2(r(2, 1), r(2, 2)));
}

std::string DirectionHtml(const std::string& name, const std::string& formula,
                          const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  Eigen::Quaterniond q = pose.rotation;
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const Eigen::Vector3d euler = EulerOf(pose);
  return fmt::format(
      "<div class=\"direction\"><h3><code>{}</code></h3>\n<p class=\"note\"><code>{}</code></p>\n"
      "<div class=\"wide\"><table class=\"facts\"><tbody>\n"
      "<tr><th>translation x, y, z</th><td>{} &nbsp; {} &nbsp; {} m</td></tr>\n"
      "<tr><th>quaternion w, x, y, z</th><td>{} &nbsp; {} &nbsp; {} &nbsp; {}</td></tr>\n"
      "<tr><th>yaw, pitch, roll (Rz Ry Rx)</th><td>{} &nbsp; {} &nbsp; {} deg</td></tr>\n"
      "</tbody></table></div>\n<pre>{}</pre></div>\n",
      HtmlText(name), HtmlText(formula), Fixed(t.x(), 5), Fixed(t.y(), 5), Fixed(t.z(), 5),
      Fixed(q.w(), 6), Fixed(q.x(), 6), Fixed(q.y(), 6), Fixed(q.z(), 6), Fixed(euler.x(), 3),
      Fixed(euler.y(), 3), Fixed(euler.z(), 3), MatrixText(pose));
}

// Blue for positive and orange for negative correlations, stronger with their size.
std::string CellColour(double value) {
  const double strength = std::min(1.0, std::abs(value));
  const Eigen::Vector3d white(255, 255, 255);
  const Eigen::Vector3d full =
      value < 0.0 ? Eigen::Vector3d(240, 150, 70) : Eigen::Vector3d(110, 170, 225);
  const Eigen::Vector3d rgb = white + strength * (full - white);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(rgb.x()), static_cast<int>(rgb.y()),
                     static_cast<int>(rgb.z()));
}

// The first digits, which distinguish two sets of inputs; the whole is beside the files.
std::string HashHtml(const std::string& hash) {
  constexpr std::size_t kDigits = 16;
  if (hash.empty()) return {};
  return fmt::format(" · <a href=\"#inputs\">inputs</a> <code>{}</code>",
                     HtmlText(hash.substr(0, kDigits)));
}

}  // namespace

std::string SummaryHtml(const ReportPage& page) {
  std::string html = fmt::format(
      "<header>\n<p class=\"kicker\">{}</p>\n<h1>{}</h1>\n<p class=\"note\">{}{}"
      "sextant {}{}</p>\n</header>\n",
      HtmlText(page.kind), HtmlText(page.title), HtmlText(page.date),
      page.date.empty() ? "" : " · ", HtmlText(page.version), HashHtml(page.inputs.hash));
  html += VerdictHtml(page.verdict);
  if (page.figures.empty()) return html;
  html += "<dl class=\"figures\">\n";
  for (const PageFigure& figure : page.figures) {
    html += fmt::format("<div><dt>{}</dt><dd><b>{}</b><span>{}</span></dd></div>\n",
                        HtmlText(figure.label), HtmlText(figure.value), HtmlText(figure.note));
  }
  return html + "</dl>\n";
}

std::string TransformHtml(const PageTransform& transform) {
  const auto name = [](const std::string& to, const std::string& from) {
    return to + "_from_" + from;
  };
  const auto formula = [&](const std::string& to, const std::string& from) {
    return fmt::format("point_in_{} = {} * point_in_{}", to, name(to, from), from);
  };
  const std::string& to = transform.to;
  const std::string& from = transform.from;
  std::string html = transform.in_words.empty()
                         ? fmt::format("<h3>{}</h3>\n", HtmlText(name(to, from)))
                         : fmt::format("<p class=\"lead\">{}</p>\n", HtmlText(transform.in_words));
  if (transform.sigma) {
    const Vector6d& s = *transform.sigma;
    html += TableHtml(
        {.header = {"1 sigma", "x", "y", "z"},
         .rows = {{"rotation about [deg]", Fixed(kDegPerRad * s(0), 3), Fixed(kDegPerRad * s(1), 3),
                   Fixed(kDegPerRad * s(2), 3)},
                  {"translation along [mm]", Fixed(1e3 * s(3), 2), Fixed(1e3 * s(4), 2),
                   Fixed(1e3 * s(5), 2)}},
         .note = fmt::format("In the axes of the frame {} (camera: x right, y down, z forward; "
                             "LiDAR: x forward, y left, z up).",
                             to)});
  }
  html += "<div class=\"two\">\n";
  html += DirectionHtml(name(to, from), formula(to, from), transform.to_from_from);
  html += DirectionHtml(name(from, to), formula(from, to), transform.to_from_from.Inverse());
  return html + "</div>\n";
}

std::string CorrelationHtml(const PageCorrelation& correlation) {
  std::string html =
      "<figure class=\"plot\"><h3>Correlation of the six unknowns</h3><div class=\"wide\"><table "
      "class=\"heat\"><thead><tr><td></td>";
  for (const std::string& name : correlation.names) {
    html += fmt::format("<th class=\"n\">{}</th>", HtmlText(name));
  }
  html += "</tr></thead><tbody>\n";
  for (Eigen::Index row = 0; row < correlation.values.rows(); ++row) {
    html +=
        fmt::format("<tr><th>{}</th>", HtmlText(correlation.names[static_cast<std::size_t>(row)]));
    for (Eigen::Index column = 0; column < correlation.values.cols(); ++column) {
      const double value = correlation.values(row, column);
      html += fmt::format("<td class=\"n\" style=\"background:{}\">{}</td>", CellColour(value),
                          Fixed(value, 2));
    }
    html += "</tr>\n";
  }
  return html +
         "</tbody></table></div><figcaption>Near 1 or -1: the views do not separate the two, and "
         "an error in one is compensated by the other. Boards at other ranges, places in the image "
         "and tilts separate them.</figcaption></figure>\n";
}

}  // namespace sextant
