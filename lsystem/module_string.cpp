// Numbers are printed in the shortest form that reads back as the same double.
#include "lsystem/module_string.h"

#include <cmath>

#include "core/text/numbers.h"

namespace cloudbake {

namespace {

void printArguments(const ModuleString& string, const Module& module, std::string& out) {
  out += '(';
  for (size_t k = 0; k < module.argument_count; ++k) {
    if (k > 0) out += ',';
    const double value = string.arguments[module.first_argument + k];
    if (k == 0 && module.text >= 0) out += '"' + string.texts[size_t(module.text)] + '"';
    if (std::isnan(value)) continue;
    out += shortestText(value);
  }
  out += ')';
}

}  // namespace

std::string printModules(const ModuleString& string, bool with_arguments, size_t limit) {
  std::string out;
  for (const Module& module : string.modules) {
    out += module.symbol;
    if (with_arguments && module.argument_count > 0) printArguments(string, module, out);
    if (limit == 0 || out.size() <= limit) continue;
    out.resize(limit);
    return out + "…";
  }
  return out;
}

}  // namespace cloudbake
