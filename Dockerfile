# SPDX-License-Identifier: Apache-2.0
# docker build -t weft . && docker run --rm -v "$PWD:/work" weft run demo.yaml
#
# An image with the three packages of this tree, for use and for building plugins.
FROM debian:12-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates
COPY . /weft
WORKDIR /weft
RUN ./scripts/bootstrap.sh --without-pocl \
  && cmake --preset release -DWEFT_BUILD_TESTS=OFF \
  && cmake --build --preset release \
  && cpack --config build/release/CPackConfig.cmake -G DEB -B /packages

FROM debian:12-slim
COPY --from=build /packages/*.deb /packages/
RUN apt-get update \
  && apt-get install -y --no-install-recommends /packages/*.deb g++ cmake make pkg-config libeigen3-dev \
  && rm -rf /var/lib/apt/lists/* /packages
WORKDIR /work
ENTRYPOINT ["weft"]
CMD ["--help"]
