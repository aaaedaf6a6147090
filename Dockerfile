# knotdock as a container: a static program and nothing else.
#
#     docker build -t knotdock .
#     docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/data" knotdock dock receptor.pdb ligand.pdb -o run
#
# With --user the files it writes are yours. Without it nobody (65534) runs it, who may write to folders open to all alone.
FROM node:20.20.2-bookworm-slim AS viewer
COPY viewer/package.json viewer/package-lock.json /viewer/
RUN npm ci --ignore-scripts --prefix /viewer

FROM rust:1.95.0-slim-bookworm AS build
RUN apt-get update && apt-get install --yes musl-tools && rustup target add "$(uname -m)-unknown-linux-musl"
WORKDIR /source
COPY . .
COPY --from=viewer /viewer/node_modules viewer/node_modules
RUN target="$(uname -m)-unknown-linux-musl" \
    && cargo build --release --locked -p knotdock-cli --no-default-features --features viewer,serve --target "$target" \
    && cp "target/$target/release/knotdock" /knotdock

FROM scratch
COPY --from=build /knotdock /knotdock
WORKDIR /data
USER 65534:65534
ENTRYPOINT ["/knotdock"]
