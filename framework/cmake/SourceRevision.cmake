# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=FOLDER -DOUTPUT=FILE -P SourceRevision.cmake: writes the commit of SOURCE into a
# source file, which is touched only when the commit changed. Without git, or outside of a
# repository, it is empty.
set(revision "")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --exclude=* --abbrev=12
      --dirty=+changes
    OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "// SPDX-License-Identifier: Apache-2.0
#include <pipeline/runs/source_revision.hpp>

namespace weft::host {

const char* source_revision() { return \"${revision}\"; }

}  // namespace weft::host
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE ${OUTPUT} "${text}")
endif()
