// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/core/index.hpp>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::head;
using ::testing::IsEmpty;
using testing::lines;
using ::testing::Not;
using ::testing::StartsWith;

class Wiring : public testing::PipelineTest {
 protected:
  Graph wired(const std::string& text) {
    auto [pipeline, report] = check(text);
    EXPECT_TRUE(report.ok()) << report.text();
    return report.ok() ? std::move(pipeline.graph) : Graph{};
  }

  /// "correspondences=filters previous.shape=previous?": inputs with where they come from.
  static std::string inputs(const Graph& graph, const Node& node) {
    std::string text;
    for (const InputLink& link : node.inputs) {
      const ValueInfo& value = graph.values[to_index(link.value)];
      EXPECT_EQ(value.slot, link.slot);
      text += (text.empty() ? "" : " ") + link.slot + "=" + value.name + (link.required ? "" : "?");
    }
    return text;
  }
  static std::string inputs(const Graph& graph, std::size_t stage) {
    return stage < graph.stages.size() ? inputs(graph, graph.stages[stage]) : "no such stage";
  }
};

TEST_F(Wiring, GivesEachStageTheLatestValueOfEachType) {
  const Graph graph = wired(chain());
  EXPECT_EQ(inputs(graph, 0), "image=sources");
  EXPECT_EQ(inputs(graph, 1), "keypoints=detectors template_keypoints=detectors");
  EXPECT_EQ(inputs(graph, 2), "correspondences=matchers previous.shape=previous?");
  EXPECT_EQ(inputs(graph, 3), "correspondences=filters template=templates");
  EXPECT_EQ(inputs(graph, 4), "template=templates camera=sources warp_samples=warps");
  EXPECT_EQ(inputs(graph, 5),
            "template=templates camera=sources sightlines=passes previous.shape=previous?");
  ASSERT_EQ(graph.sinks.size(), 1U);
  EXPECT_EQ(inputs(graph, graph.sinks[0]), "shape=solvers? correspondences=filters?");
}

TEST_F(Wiring, ChainsFilters) {
  const Graph graph = wired(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern}\n"
                            "  - {use: filters/test.scripted}\n"
                            "  - {use: filters/test.scripted}\n"
                            "  - {use: filters/test.scripted}\n");
  EXPECT_THAT(inputs(graph, 1), StartsWith("correspondences=matchers"));
  EXPECT_THAT(inputs(graph, 2), StartsWith("correspondences=filters"));
  EXPECT_THAT(inputs(graph, 3), StartsWith("correspondences=filters#2"));
}

TEST_F(Wiring, LetsFromChooseAnEarlierStageAnUnnamedOneOrTheSource) {
  const Graph graph = wired(
      "weft: 1\nsource: {use: sources/test.matches}\ntemplate: {use: templates/test.scripted}\n"
      "stages:\n"
      "  - {use: matchers/test.pattern, as: a}\n"
      "  - {use: filters/test.scripted}\n"
      "  - {use: filters/test.scripted, from: {correspondences: a}}\n"
      "  - {use: filters/test.scripted, from: {correspondences: sources}}\n"
      "  - {use: filters/test.scripted, from: {correspondences: filters}}\n"
      "  - {use: matchers/test.merge, from: {correspondences: [a, filters#2]}}\n"
      "sinks:\n"
      "  - {use: sinks/test.scripted, from: {correspondences: a}}\n");
  EXPECT_THAT(inputs(graph, 2), StartsWith("correspondences=a"));
  EXPECT_THAT(inputs(graph, 3), StartsWith("correspondences=sources"));
  EXPECT_THAT(inputs(graph, 4), StartsWith("correspondences=filters"));
  EXPECT_EQ(inputs(graph, 5), "correspondences=a? correspondences=filters#2?");
  EXPECT_EQ(inputs(graph, graph.sinks[0]), "correspondences=a?");
}

TEST_F(Wiring, RefusesFromThatChoosesWhatIsNotThere) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern, as: first, from: {keypoint: a}}\n"
                            "  - {use: filters/test.scripted, from: {correspondences: frist}}\n"
                            "  - {use: filters/test.scripted, from: {correspondences: nobody}}\n"
                            "  - {use: filters/test.scripted, from: {correspondence: first}}\n"
                            "  - {use: filters/test.scripted, from: {correspondences: [first, "
                            "first]}}\n"
                            "  - {use: filters/test.scripted, as: later}\n")
                          .second;
  EXPECT_THAT(
      lines(report),
      ElementsAre("5:52: matchers/test.pattern does not read 'keypoint'",
                  "6:41: no earlier stage named 'frist' produces 'correspondences'; did you mean "
                  "'first'?",
                  "7:41: no earlier stage named 'nobody' produces 'correspondences'; name it "
                  "with: as: nobody",
                  "8:41: filters/test.scripted does not read 'correspondence'; did you mean "
                  "'correspondences'?",
                  "9:41: filters/test.scripted takes one 'correspondences' only"));
}

TEST_F(Wiring, LetsFromReadEarlierFrames) {
  const Graph graph = wired(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern}\n"
                            "  - {use: filters/test.scripted, from: {previous.shape: "
                            "previous.shape@3, correspondences: previous.correspondences}}\n"
                            "  - {use: warps/test.scripted}\n"
                            "  - {use: passes/test.scripted}\n"
                            "  - {use: solvers/test.scripted, from: {previous.shape: "
                            "previous.shape}}\n");
  const auto lag = [&](std::size_t stage, std::size_t input) {
    return graph.values[to_index(graph.stages[stage].inputs[input].value)].lag;
  };
  EXPECT_EQ(lag(1, 0), 1);
  EXPECT_EQ(lag(1, 1), 3);
  EXPECT_TRUE(graph.stages[1].inputs[0].required);
  EXPECT_FALSE(graph.stages[1].inputs[1].required);
  EXPECT_EQ(lag(4, 3), 1);
}

TEST_F(Wiring, LetsAStageRefineWhatAnotherMadeInTheSameFrame) {
  const auto refining = [](const std::string& made_by) {
    std::string text = chain();
    return text.insert(
        text.find("sinks:"),
        "  - {use: solvers/test.scripted, as: refined, from: {previous.shape: " + made_by + "}}\n");
  };
  const auto [pipeline, report] = check(refining("solvers"));
  ASSERT_TRUE(report.ok()) << report.text();
  const InputLink& start = pipeline.graph.stages.back().inputs.back();
  EXPECT_EQ(start.slot, "previous.shape") << "as the component sees it";
  EXPECT_FALSE(start.required);
  const ValueInfo& value = pipeline.graph.values[to_index(start.value)];
  EXPECT_EQ(value.slot, "shape");
  EXPECT_EQ(value.name, "solvers");
  EXPECT_THAT(check(refining("warps")).second.text(),
              HasSubstr("'warps' makes warp, warp_samples, not 'shape'"));
}

TEST_F(Wiring, GivesASinkTheShapeOfAnotherStageWhereFromNamesIt) {
  const auto shown = [](const std::string& from) {
    const std::string text =
        chain() + "  - {use: sinks/test.steering, as: wheel, params: {path: w.txt}" + from + "}\n";
    std::string both = text;
    return both.insert(both.find("sinks:"), "  - {use: solvers/test.scripted, as: refined}\n");
  };
  const auto other = [](const Graph& graph) -> const InputLink* {
    for (const InputLink& link : graph.sinks.back().inputs) {
      if (link.slot == "other_shape") return &link;
    }
    return nullptr;
  };
  const Graph graph = wired(shown(", from: {other_shape: solvers}"));
  ASSERT_NE(other(graph), nullptr);
  const ValueInfo& value = graph.values[to_index(other(graph)->value)];
  EXPECT_EQ(value.slot, "shape");
  EXPECT_EQ(value.name, "solvers");
  EXPECT_EQ(other(wired(shown(""))), nullptr) << "it has none by itself";
  EXPECT_THAT(check(shown(", from: {other_shape: warps}")).second.text(),
              HasSubstr("'warps' makes warp, warp_samples, not 'shape'"));
}

TEST_F(Wiring, RefusesEarlierFramesThatCannotBe) {
  const auto refusal = [&](const std::string& from) {
    const auto found = lines(check(head() +
                                   "stages:\n"
                                   "  - {use: matchers/test.pattern}\n"
                                   "  - {use: filters/test.scripted, from: {" +
                                   from + "}}\n")
                                 .second);
    return found.size() == 1 ? found[0] : std::to_string(found.size()) + " mistakes";
  };
  EXPECT_EQ(refusal("correspondences: previous.shape"),
            "6:41: 'correspondences' cannot be read from 'previous.shape'");
  EXPECT_THAT(refusal("correspondences: previous.correspondences@0"),
              HasSubstr("@k, k frames ago, with k from 1 to 1000"));
  EXPECT_THAT(refusal("correspondences: previous.correspondences@"), HasSubstr("k frames ago"));
  EXPECT_THAT(refusal("correspondences: previous.correspondences@x"), HasSubstr("k frames ago"));
  EXPECT_THAT(refusal("correspondences: previous.correspondences@1001"), HasSubstr("to 1000"));
  EXPECT_EQ(refusal("previous.shape: previous.shape@2"),
            "6:41: nothing produces 'shape', so that there is no 'previous.shape@2'");
}

TEST_F(Wiring, RefusesFromAStageThatComesLater) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern}\n"
                            "  - {use: filters/test.scripted, from: {correspondences: b}}\n"
                            "  - {use: matchers/test.pattern, as: b}\n")
                          .second;
  EXPECT_THAT(lines(report), ElementsAre("6:41: 'b' comes later; move it up, before 'filters'"));
}

constexpr const char* kTwoDetectors =
    "stages:\n"
    "  - {use: detectors/test.scripted, as: coarse}\n"
    "  - {use: matchers/test.scripted, as: first}\n"
    "  - {use: detectors/test.scripted, as: fine}\n"
    "  - {use: matchers/test.scripted, as: second}\n"
    "  - {use: matchers/test.scripted, from: {keypoints: coarse}}\n"
    "  - {use: matchers/test.merge, from: {correspondences: [first, second]}}\n";

TEST_F(Wiring, KeepsBothKeypointsOfADetectorTogether) {
  const Graph graph = wired(head() + kTwoDetectors);
  EXPECT_EQ(inputs(graph, 1), "keypoints=coarse template_keypoints=coarse");
  EXPECT_EQ(inputs(graph, 3), "keypoints=fine template_keypoints=fine");
  EXPECT_EQ(inputs(graph, 4), "keypoints=coarse template_keypoints=coarse");
  EXPECT_EQ(inputs(graph, 5), "correspondences=first? correspondences=second?");
}

TEST_F(Wiring, RefusesTemplateKeypointsOfAnotherDetector) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: detectors/test.scripted, as: a}\n"
                            "  - {use: matchers/test.scripted, from: {template_keypoints: a}}\n")
                          .second;
  EXPECT_THAT(lines(report),
              ElementsAre("6:42: 'from' chooses both kinds of keypoints with: keypoints"));
}

TEST_F(Wiring, NamesWhatCouldProduceAMissingInput) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: matchers/test.scripted}\n"
                            "  - {use: passes/test.scripted}\n"
                            "  - {use: filters/test.truth}\n"
                            "  - {use: solvers/test.scripted}\n"
                            "sinks:\n"
                            "  - {use: sinks/test.visibility}\n")
                          .second;
  const std::string detector =
      ";\n    add one that produces it: detectors/test.scripted, "
      "detectors/test.device, detectors/test.silent";
  EXPECT_THAT(
      lines(report),
      ElementsAre(
          "5:5: matchers/test.scripted requires 'keypoints', which no earlier stage produces" +
              detector,
          "5:5: matchers/test.scripted requires 'template_keypoints', which no earlier stage "
          "produces" +
              detector,
          "6:5: passes/test.scripted requires 'warp_samples', which no earlier stage produces;\n"
          "    add one that produces it: warps/test.scripted",
          HasSubstr("7:5: no component reads the correspondences of 'filters'")));
}

TEST_F(Wiring, NamesPassesForAPipelineWithoutOne) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: solvers/test.scripted}\n"
                            "sinks:\n"
                            "  - {use: sinks/test.visibility}\n")
                          .second;
  EXPECT_THAT(
      lines(report),
      ElementsAre("5:5: solvers/test.scripted requires 'sightlines', which no earlier stage "
                  "produces;\n    add one that produces it: passes/test.scripted",
                  "7:5: sinks/test.visibility requires 'visibility', which no earlier stage "
                  "produces;\n    add one that produces it: passes/test.scripted, "
                  "passes/test.memory"));
}

TEST_F(Wiring, CountsAFailedStageAsAProducer) {
  const auto report = check(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern, params: {count: -4}}\n"
                            "  - {use: filters/test.scripted}\n")
                          .second;
  EXPECT_THAT(lines(report), ElementsAre(HasSubstr("'count' is -4")));
}

TEST_F(Wiring, MakesRequiredInputsOfANestedComponentTheParents) {
  const Graph graph = wired(head() +
                            "stages:\n"
                            "  - {use: matchers/test.pattern}\n"
                            "  - {use: warps/test.scripted}\n"
                            "  - {use: passes/test.scripted}\n"
                            "  - {use: solvers/test.holder}\n");
  EXPECT_EQ(inputs(graph, 3),
            "template=templates camera=sources sightlines=passes previous.shape=previous?");
  const auto report = check(head() + "stages:\n  - {use: solvers/test.holder}\n").second;
  EXPECT_THAT(lines(report), ElementsAre(HasSubstr("solvers/test.holder requires 'sightlines'")));
}

TEST_F(Wiring, GivesTruthOnlyToThoseWhoSayThatTheyUseIt) {
  const auto with = [](const std::string& filter) {
    return head("{truth: true}") +
           "stages:\n  - {use: matchers/test.pattern}\n  - {use: " + filter + "}\n";
  };
  EXPECT_EQ(inputs(wired(with("filters/test.truth")), 1),
            "correspondences=matchers ground_truth=sources");
  EXPECT_THAT(
      lines(check(with("filters/test.peeking")).second),
      ElementsAre("6:5: filters/test.peeking reads ground_truth without declaring uses_truth"));
}

TEST_F(Wiring, RefusesAnInputThatTheSourceNeverGives) {
  const auto report =
      check(
          "weft: 1\nsource: {use: sources/test.matches}\ntemplate: {use: templates/test.scripted}\n"
          "stages:\n"
          "  - {use: detectors/test.scripted}\n")
          .second;
  EXPECT_THAT(lines(report),
              ElementsAre("5:5: detectors/test.scripted requires 'image', which no earlier stage "
                          "produces;\n    add one that produces it: sources/test.scripted"));
}

TEST_F(Wiring, FeedsBackWhatSomeStageProducesAndRequiresNoneOfIt) {
  const Graph alone = wired(head() + "stages:\n  - {use: passes/test.memory}\n");
  EXPECT_EQ(inputs(alone, 0), "template=templates camera=sources previous.visibility=previous?");
  const Graph graph = wired(head() +
                            "stages:\n"
                            "  - {use: passes/test.memory}\n"
                            "  - {use: matchers/test.pattern}\n"
                            "  - {use: warps/test.scripted}\n"
                            "  - {use: passes/test.scripted}\n"
                            "  - {use: solvers/test.scripted}\n");
  EXPECT_EQ(inputs(graph, 0),
            "template=templates camera=sources previous.visibility=previous? "
            "previous.shape=previous?");
}

TEST_F(Wiring, HasNoLatestValueOfAnUnknownSlot) {
  const Graph graph = wired(chain());
  EXPECT_EQ(graph.latest("region"), -1);
  EXPECT_EQ(graph.values[to_index(graph.latest("shape"))].name, "solvers");
}

}  // namespace
}  // namespace weft
