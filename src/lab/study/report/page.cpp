#include "study/report/page.h"

#include <fmt/core.h>

#include "study/markup.h"
#include "study/plot/style.h"
#include "study/report/assets.h"

namespace culprit::study {
namespace {

std::string style() {
  return "<style>\n" + std::string(kReportStyle) + plot_style(ColorScheme::kLight) +
         "@media (prefers-color-scheme: dark) {\n" + plot_style(ColorScheme::kDark) +
         "}\n</style>\n";
}

}  // namespace

std::string page_head(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
         "<title>" +
         markup_escaped(title) + " – culprit study</title>\n" + style() + "</head>\n";
}

std::string page_fact(std::string_view name, const std::string& value_html) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, value_html);
}

}  // namespace culprit::study
