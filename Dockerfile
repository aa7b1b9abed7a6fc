# Two stages: one that builds, one that holds the two executables and the libraries they need. main_view is in the
# image too, so that compose can show the pair at work.
FROM debian:bookworm-slim AS build
WORKDIR /src
# On its own first, so that an edited source does not install everything again.
COPY scripts/setup scripts/lib.sh scripts/packages.txt scripts/
RUN scripts/setup && apt-get clean && rm -rf /var/lib/apt/lists/*
COPY . .
RUN cmake --preset release -DSIGHTLINE_BUILD_TESTS=OFF -DSIGHTLINE_BUILD_BENCHMARKS=OFF \
 && scripts/build release control_view main_view \
 && strip build/release/bin/control_view build/release/bin/main_view

FROM debian:bookworm-slim
COPY scripts/setup scripts/lib.sh scripts/packages.txt /tmp/scripts/
RUN /tmp/scripts/setup --runtime \
 && apt-get clean \
 && rm -rf /tmp/scripts /var/lib/apt/lists/* /var/cache/apt/*.bin /usr/share/doc /usr/share/man /usr/share/locale \
 && useradd --system --uid 10001 --home-dir /nonexistent sightline
COPY --from=build /src/build/release/bin/control_view /src/build/release/bin/main_view /usr/local/bin/
# A library that scripts/packages.txt forgot stops the build, not the user.
RUN ! ldd /usr/local/bin/control_view /usr/local/bin/main_view | grep 'not found'
COPY scenes /usr/local/share/sightline/scenes
COPY LICENSE /usr/local/share/sightline/
USER sightline
EXPOSE 5571
HEALTHCHECK --interval=2s --timeout=5s --start-period=60s --retries=5 \
  CMD ["control_view", "ping", "--connect", "tcp://127.0.0.1:5571"]
CMD ["control_view", "serve", "--bind", "tcp://0.0.0.0:5571", \
     "--scene", "/usr/local/share/sightline/scenes/clinic_ground.glb"]
