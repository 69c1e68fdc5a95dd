// SPDX-License-Identifier: Apache-2.0
#include "device.hpp"
#include "filters.hpp"
#include "inputs.hpp"
#include "matches.hpp"
#include "outputs.hpp"
#include "shapes.hpp"

using namespace scripted;

WEFT_LIBRARY(
    WEFT_COMPONENT(FrameSource, "sources/test.scripted", "1.0.0", "Grey frames by script."),
    WEFT_COMPONENT(MatchSource, "sources/test.matches", "1.0.0", "Matches without an image."),
    WEFT_COMPONENT(Sheet, "templates/test.scripted", "1.0.0", "A flat sheet, or a broken one."),
    WEFT_COMPONENT(GridDetector, "detectors/test.scripted", "1.0.0", "Keypoints on a grid."),
    WEFT_COMPONENT(DeviceDetector<true>, "detectors/test.device", "1.0.0",
                   "Descriptors elsewhere."),
    WEFT_COMPONENT(DeviceDetector<false>, "detectors/test.silent", "1.0.0", "Without saying so."),
    WEFT_COMPONENT(FindingMatcher<true>, "matchers/test.finding", "1.0.0", "Finds them itself."),
    WEFT_COMPONENT(FindingMatcher<false>, "matchers/test.finding_here", "1.0.0", "Reads here."),
    WEFT_COMPONENT(DescriptorReader<true>, "matchers/test.device", "1.0.0", "Reads them there."),
    WEFT_COMPONENT(DescriptorReader<false>, "matchers/test.reading", "1.0.0", "Reads them here."),
    WEFT_COMPONENT(HandingMatcher, "matchers/test.handing", "1.0.0", "Has another one read them."),
    WEFT_COMPONENT(IndexMatcher, "matchers/test.scripted", "1.0.0", "Pairs by index."),
    WEFT_COMPONENT(PatternMatcher, "matchers/test.pattern", "1.0.0", "Matches without keypoints."),
    WEFT_COMPONENT(Merger<true>, "matchers/test.merge", "1.0.0",
                   "All matches of several matchers."),
    WEFT_COMPONENT(Merger<false>, "matchers/test.beside", "1.0.0", "Reads them with an image."),
    WEFT_COMPONENT(EveryFilter, "filters/test.scripted", "1.0.0", "Rejects every so many."),
    WEFT_COMPONENT(RandomFilter, "filters/test.random", "1.0.0", "Keeps what the draw wants."),
    WEFT_COMPONENT(WarpedFilter, "filters/test.warped", "1.0.0", "Holds a warp."),
    WEFT_COMPONENT(TruthFilter<true>, "filters/test.truth", "1.0.0", "Reads the truth."),
    WEFT_COMPONENT(TruthFilter<false>, "filters/test.peeking", "1.0.0", "Reads it in secret."),
    WEFT_COMPONENT(AffineWarp, "warps/test.scripted", "1.0.0", "An affine map."),
    WEFT_COMPONENT(VertexPass, "passes/test.scripted", "1.0.0", "Sightlines of all vertices."),
    WEFT_COMPONENT(MemoryPass, "passes/test.memory", "1.0.0", "Tells what was fed back."),
    WEFT_COMPONENT(PlaneSolver, "solvers/test.scripted", "1.0.0", "A plane."),
    WEFT_COMPONENT(HolderSolver, "solvers/test.holder", "1.0.0", "Holds a solver."),
    WEFT_COMPONENT(WarpSolver, "solvers/test.warped", "1.0.0", "Wants a warp."),
    WEFT_COMPONENT(KnownSolver, "solvers/test.known", "1.0.0", "Wants a known point."),
    WEFT_COMPONENT(LineSink, "sinks/test.scripted", "1.0.0", "A line for each frame."),
    WEFT_COMPONENT(SteeringSink, "sinks/test.steering", "1.0.0", "Wishes by script."),
    WEFT_COMPONENT(VisibilitySink, "sinks/test.visibility", "1.0.0", "Wants visibility."))
