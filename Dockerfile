# The service in a container. It runs on a GPU if the container runtime mounts its driver, else on the software driver in
# the image.
#
#   docker build -t caustica .
#   docker run --rm -p 8080:8080 caustica
#   docker run --rm -p 8080:8080 --gpus all caustica serve --adapter gpu

FROM rust:1.95-slim-bookworm AS build
WORKDIR /src
COPY deploy/install-deps.sh deploy/
RUN deploy/install-deps.sh --build && rm -rf /var/lib/apt/lists/*
COPY . .
# The caches live outside the image, so the program is copied out of them in the same step.
RUN --mount=type=cache,target=/usr/local/cargo/registry \
    --mount=type=cache,target=/src/target \
    cargo build --release --locked && cp target/release/caustica /usr/local/bin/caustica

FROM debian:bookworm-slim
RUN --mount=type=bind,source=deploy/install-deps.sh,target=/install-deps.sh \
    /install-deps.sh --container && rm -rf /var/lib/apt/lists/*
COPY --from=build /usr/local/bin/caustica /usr/local/bin/caustica
RUN useradd --system --uid 10001 --create-home --shell /usr/sbin/nologin caustica
USER caustica
WORKDIR /home/caustica

# Vulkan needs `graphics`; setting the variable replaces NVIDIA's default, so all three are named.
# Mesa's device selection prints errors if there is no display, so it is switched off.
ENV NVIDIA_DRIVER_CAPABILITIES=compute,utility,graphics \
    NODEVICE_SELECT=1 \
    CAUSTICA_LISTEN=0.0.0.0:8080
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=5s --start-period=30s --retries=3 CMD ["caustica", "health"]
ENTRYPOINT ["caustica"]
CMD ["serve"]
