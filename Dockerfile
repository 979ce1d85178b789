# The program in a container:  docker build -t spool . && docker run --rm -v "$PWD:/data" spool info /data/NAME.spool
# Versions of packages are those of Debian 12, hence no pins (DL3008).
FROM debian:bookworm-slim AS build
# hadolint ignore=DL3008
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates && rm -rf /var/lib/apt/lists/*
COPY . /spool
WORKDIR /spool
RUN tools/dev.sh package

FROM debian:bookworm-slim
COPY --from=build /spool/build/release/packages /packages
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install -y --no-install-recommends /packages/spool_*.deb /packages/spool-png_*.deb /packages/python3-spool_*.deb python3-matplotlib \
    && rm -rf /var/lib/apt/lists/* /packages
WORKDIR /data
ENTRYPOINT ["spool"]
CMD ["--help"]
