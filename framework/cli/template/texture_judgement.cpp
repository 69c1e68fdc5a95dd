// SPDX-License-Identifier: Apache-2.0
#include "cli/template/texture_judgement.hpp"

#include "cli/standard_components.hpp"
#include "cli/template/template_builder.hpp"
#include "cli/template/template_picture.hpp"

namespace weft::cli {

Result<TextureSurvey> judge_texture(const host::Registry& registry, const host::Record& templ,
                                    const TemplateSurvey& numbers) {
  const StandardFeatures features = standard_features();
  const auto detector = resolve_text(registry, features.detector);
  if (!detector) return detector.error();
  const auto matcher = resolve_text(registry, features.matcher);
  if (!matcher) return matcher.error();
  return survey_texture(templ, numbers, *detector, *matcher);
}

Result<void> write_twins(const host::Registry& registry, const host::Record& templ,
                         const TextureSurvey& texture, const std::string& path) {
  const auto pairs = host::Record::copy_of(texture.twins);
  if (pairs == nullptr) return Error{Errc::no_memory, "no memory for the image"};
  const weft_record inputs[] = {templ.view("template"), pairs->view("correspondences")};
  return write_picture(registry, inputs, Picture::twins, path);
}

}  // namespace weft::cli
