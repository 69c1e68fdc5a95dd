# SPDX-License-Identifier: Apache-2.0
#
# Imported targets opencv_core, opencv_imgproc ... from Debian's single packages: only the package
# of all of OpenCV (0.7 GB with what it pulls in) brings a CMake configuration. There is no target
# opencv_aruco where that module, of libopencv-contrib-dev, is not installed.

find_path(WEFT_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
find_path(WEFT_OPENCV_ARUCO_INCLUDE opencv2/aruco.hpp PATH_SUFFIXES opencv4)
find_library(WEFT_OPENCV_aruco opencv_aruco)
foreach(module core imgproc features2d calib3d imgcodecs videoio aruco)
  if(module STREQUAL "aruco" AND NOT (WEFT_OPENCV_aruco AND WEFT_OPENCV_ARUCO_INCLUDE))
    continue()
  endif()
  find_library(WEFT_OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv_${module} SHARED IMPORTED GLOBAL)
  set_target_properties(opencv_${module} PROPERTIES
    IMPORTED_LOCATION ${WEFT_OPENCV_${module}}
    INTERFACE_INCLUDE_DIRECTORIES ${WEFT_OPENCV_INCLUDE})
endforeach()
