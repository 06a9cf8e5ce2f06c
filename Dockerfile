# The command line, `alula-sil`, in a container of its own. CI does not build it: there is no registry of images where it runs.
#
#   docker build -t alula .
#   docker run --rm -v "$PWD:/work" alula fly mission         # leaves out/mission
FROM rust:1-bookworm AS build
WORKDIR /alula
COPY . .
# The image's own Rust, and not one that rust-toolchain.toml would fetch with its targets: that of browsers is for `view --live`.
RUN rm rust-toolchain.toml && rustup target add wasm32-unknown-unknown && cargo build --release --locked -p alula-sil

FROM debian:bookworm-slim
COPY --from=build /alula/target/release/alula-sil /usr/local/bin/
WORKDIR /work
ENTRYPOINT ["alula-sil"]
