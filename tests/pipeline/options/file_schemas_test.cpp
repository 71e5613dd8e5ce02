// The schemas of manifests and recipes against the readers of both: what fits a schema is read, and what is out of a range is not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "lsystem/recipe.h"
#include "pipeline/batch/manifest.h"
#include "pipeline/batch/plan.h"
#include "pipeline/options/option_json.h"
#include "pipeline/options/presets.h"
#include "tests/folders.h"
#include "tests/pipeline/option_samples.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

// Whether a value fits a schema that has the words that ours have. Any other word is an error.
bool fits(const Json& schema, const Json& value) {
  const auto any = [&](const Json& schemas) {
    return std::count_if(schemas.begin(), schemas.end(), [&](const Json& one) { return fits(one, value); });
  };
  const std::map<std::string, bool> types{{"object", value.is_object()},          {"array", value.is_array()},
                                          {"string", value.is_string()},          {"boolean", value.is_boolean()},
                                          {"integer", value.is_number_integer()}, {"number", value.is_number()}};
  for (const auto& [word, rule] : schema.items()) {
    bool is_kept = true;
    if (word == "type") {
      const Json all = rule.is_array() ? rule : Json::array({rule});
      is_kept = std::any_of(all.begin(), all.end(), [&](const Json& type) { return types.at(type); });
    } else if (word == "enum") {
      is_kept = std::find(rule.begin(), rule.end(), value) != rule.end();
    } else if (word == "minimum" || word == "maximum" || word == "exclusiveMinimum") {
      const auto number = value.is_number() ? value.get<double>() : 0, limit = rule.get<double>();
      is_kept = !value.is_number() || (word == "minimum" ? number >= limit : word == "maximum" ? number <= limit : number > limit);
    } else if (word == "pattern") {
      is_kept = !value.is_string() || std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>()));
    } else if (word == "minLength") {
      is_kept = !value.is_string() || value.get<std::string>().size() >= rule.get<size_t>();
    } else if (word == "minItems" || word == "maxItems") {
      is_kept = !value.is_array() || (word == "minItems" ? value.size() >= rule : value.size() <= rule);
    } else if (word == "items") {
      is_kept = !value.is_array() || std::all_of(value.begin(), value.end(), [&own = rule](const Json& item) { return fits(own, item); });
    } else if (word == "required") {
      is_kept = std::all_of(rule.begin(), rule.end(), [&](const Json& key) { return value.contains(key.get<std::string>()); });
    } else if (word == "anyOf" || word == "oneOf") {
      is_kept = word == "oneOf" ? any(rule) == 1 : any(rule) > 0;
    } else if (word == "properties") {
      for (const auto& [key, child] : value.items()) is_kept = is_kept && (!rule.contains(key) || fits(rule[key], child));
    } else if (word == "additionalProperties") {
      for (const auto& [key, child] : value.items())
        if (!schema.contains("properties") || !schema["properties"].contains(key))
          is_kept = is_kept && rule.is_object() && fits(rule, child);
    } else if (word != "description" && word != "title" && word != "$schema" && word != "$id") {
      ADD_FAILURE() << "the test does not know '" << word << "'";
    }
    if (!is_kept) return false;
  }
  return true;
}

Json jsonOf(const std::string& text) {
  std::stringstream json;
  const toml::table table = parseTomlTable(text, "a.toml");
  json << toml::json_formatter{table};
  return Json::parse(json.str());
}

bool isReadRecipe(const std::string& text) {
  return refusalOf([&] { parseRecipe(text, "a.toml"); }).empty();
}
// A manifest is read, and its options are set.
bool isReadManifest(const std::string& text) {
  return refusalOf([&] {
           for (const ManifestCloud& cloud : parseManifest(text, "a.toml").clouds)
             for (const ManifestValue& value : cloud.options) {
               const Option* option = findAssetOption(value.key);
               Settings settings;
               if (!option) throw UsageError("unknown key");
               if (option->value.set)
                 option->value.set(settings, *option, value.value);
               else if (value.value != "true" && value.value != "false")
                 throw UsageError("a shorthand");
             }
         })
      .empty();
}

// The ways to write a value in TOML that matter to a form: within and beyond the limits, words, texts, lists, other types.
std::vector<std::string> valuesFor(const ValueForm& form, const Samples& samples) {
  std::vector<std::string> values{"true", "'neither'", "3.5", "''", "[1, 2, 3]", "[]", "'1%'", "-1"};
  const auto add = [&](const std::string& text) {
    values.push_back("'" + text + "'");
    if (const Json number = Json::parse(text, nullptr, false); number.is_number()) values.push_back(text);
  };
  add(samples.one), add(samples.other);
  for (const auto& [text, value] : form.words)
    if (text) add(text);
  for (const double limit : {form.low, form.high})
    if (std::fabs(limit) < 0x1p62)
      for (const double number : {limit == kAboveZero ? 0 : limit, limit - std::fabs(limit) - 1, 2 * std::fabs(limit) + 1})
        values.push_back(form.kind == ValueForm::kWhole ? fmt::format("{:.0f}", number) : fmt::format("{:.17e}", number));
  return values;
}

// What fits is read. What does not is refused by the reader, too, unless it is a number or a flag in quotes, or a number for a text.
void expectAgreement(const Json& schema, const std::string& text, const std::string& value, bool is_read, bool is_text) {
  if (fits(schema, jsonOf(text))) {
    EXPECT_TRUE(is_read) << text << " fits the schema, but it is not read";
  } else if (value[0] != '\'' && value[0] != '[' && !is_text) {
    EXPECT_FALSE(is_read) << text << " is read, but it does not fit the schema";
  }
}

TEST(FileSchemas, OptionsInManifests) {
  const Json schema = manifestSchema();
  size_t fitting = 0, unfit = 0;
  for (const Option& option : optionTable()) {
    if (findAssetOption(option.name) != &option) continue;
    std::string key = option.name;
    std::replace(key.begin(), key.end(), '-', '_');
    const Samples samples = samplesOf(option);
    for (const std::string& value : valuesFor(option.value.form, samples)) {
      const std::string text = "[[cloud]]\npreset = 'hero'\n" + key + " = " + value + "\n";
      (fits(schema, jsonOf(text)) ? fitting : unfit) += 1;
      expectAgreement(schema, text, value, isReadManifest(text), option.value.form.kind == ValueForm::kText);
      const std::string defaults = "[defaults]\n" + key + " = " + value + "\n[[cloud]]\npreset = 'hero'\n";
      EXPECT_EQ(fits(schema, jsonOf(defaults)), fits(schema, jsonOf(text))) << defaults;
    }
    const bool is_number = option.value.form.kind == ValueForm::kWhole || option.value.form.kind == ValueForm::kNumber;
    const bool is_bare = option.value.form.kind == ValueForm::kFlag || (is_number && Json::parse(samples.one, nullptr, false).is_number());
    const std::string value = is_bare ? samples.one : "'" + samples.one + "'";
    EXPECT_TRUE(fits(schema, jsonOf("[[cloud]]\npreset = 'hero'\n" + key + " = " + value + "\n"))) << key << " = " << value;
  }
  EXPECT_GT(fitting, 200U);
  EXPECT_GT(unfit, 200U);
}

TEST(FileSchemas, KeysOfRecipes) {
  const Json schema = recipeSchema();
  for (const RecipeKey& key : recipeKeys()) {
    const Option* option = findOption(key.name, kGrow);
    ASSERT_TRUE(option) << key.name;
    for (const std::string& value : valuesFor(key.form, samplesOf(*option))) {
      const std::string premise = std::string_view(key.name) == "premise" ? "" : "premise = 'F'\n";
      const std::string table = *key.table ? "[" + std::string(key.table) + "]\n" : "";
      const std::string text = premise + table + key.name + " = " + value + "\n";
      if (text == "premise = ''\n") continue;  // is as good as none
      EXPECT_EQ(fits(schema, jsonOf(text)), isReadRecipe(text)) << text;
    }
  }
}

TEST(FileSchemas, WhatIsNoSingleValue) {
  const Json recipe = recipeSchema(), manifest = manifestSchema();
  for (const char* text :
       {"premise = 'F'\nrules = ['A=F', 'B=F']", "premise = 'F'\nrules = '''\nA=F\nB=F'''", "premise = 'F'\nrules = 3",
        "premise = 'F'\nrules = ['A=F', 3]", "premise = 'F'\ninner_shape = [[0, 0, 0, 1.5]]", "premise = 'F'\ninner_shape = [[0, 0, 1.5]]",
        "premise = 'F'\n[variables]\nb = 2.5\nc = 1", "premise = 'F'\n[variables]\nb = 'two'", "premise = 'F'\nraise = 3",
        "premise = 'F'\n[turtle]\nsize = 3", "premise = 'F'\nturtle = 3", "generations = 3"})
    EXPECT_EQ(fits(recipe, jsonOf(text)), isReadRecipe(text)) << text;
  EXPECT_TRUE(fits(recipe, jsonOf("premise = 'F'\n[bake]\nrays = 36\nnoise = '3%'")));
  EXPECT_FALSE(fits(recipe, jsonOf("premise = 'F'\n[bake]\nthreads = 3")));
  EXPECT_FALSE(fits(recipe, jsonOf("premise = 'F'\n[bake]\nrays = 0")));
  EXPECT_TRUE(fits(recipe, jsonOf("premise = 'F'\n[sequence]\nvary = ['b=0:1', 'c=1:2']\nframe_count = 30\nloop = true")));
  EXPECT_TRUE(fits(recipe, jsonOf("premise = 'F'\n[sequence]\nvary = 'b=0:1'")));
  EXPECT_FALSE(fits(recipe, jsonOf("premise = 'F'\n[sequence]\nrays = 32")));
  for (const char* text :
       {"name = '{stem}.glb'\n[[cloud]]\nsculpt = ['a.obj', '*.ply']", "[[cloud]]\nsculpt = []", "[[cloud]]\nsculpt = '*.obj'\nname = ''",
        "[[cloud]]\npreset = 'hero'\nseeds = [1, 2]", "[[cloud]]\npreset = 'hero'\nseeds = '1-12'",
        "[[cloud]]\npreset = 'hero'\nseeds = []", "[[cloud]]\npreset = 'hero'\nseeds = 'all'", "[[cloud]]\nname = 'a.glb'",
        "[[cloud]]\npreset = 'hero'\nrecipe = 'a.toml'", "name = 'a'", "[[cloud]]\nrules = 'a.txt'\n[clouds]",
        "[[cloud]]\npreset = 'hero'\nthreads = 3", "[[cloud]]\nsculpt = 'a.obj'\nrepair = ['orient', 'fill']",
        "[[cloud]]\nsculpt = 'a.obj'\nrepair = ['orient', 'all']", "[[cloud]]\nfrom_spheres = 'a.csv'\nvoxles = 3"})
    EXPECT_EQ(fits(manifest, jsonOf(text)), isReadManifest(text)) << text;
}

TEST(FileSchemas, FitOurFiles) {
  const Json recipe = recipeSchema(), manifest = manifestSchema();
  for (const Preset& preset : presets()) EXPECT_TRUE(fits(recipe, jsonOf(std::string(preset.toml)))) << preset.name;
  EXPECT_TRUE(fits(manifest, jsonOf(exampleManifest())));
  const auto blockOf = [](const char* page) {
    const std::string text = readFileBytes(sourceFolder() / "docs" / page), fence = "```toml\n";
    const size_t begin = text.find(fence) + fence.size();
    return text.substr(begin, text.find("```", begin) - begin);
  };
  EXPECT_TRUE(fits(recipe, jsonOf(blockOf("growing_clouds.md"))));
  EXPECT_TRUE(fits(manifest, jsonOf(blockOf("batches.md"))));
}

}  // namespace
}  // namespace cloudbake
