# knotdock as a container: a static program and nothing else.
#
#     docker build -t knotdock . && docker run --rm -v "$PWD:/data" knotdock dock receptor.pdb ligand.pdb -o run
FROM node:20-slim AS viewer
COPY viewer/package.json viewer/package-lock.json /viewer/
RUN npm ci --prefix /viewer

FROM rust:1-slim AS build
RUN apt-get update && apt-get install --yes musl-tools && rustup target add "$(uname -m)-unknown-linux-musl"
WORKDIR /source
COPY . .
COPY --from=viewer /viewer/node_modules viewer/node_modules
RUN target="$(uname -m)-unknown-linux-musl" \
    && cargo build --release --locked --no-default-features --features viewer --target "$target" \
    && cp "target/$target/release/knotdock" /knotdock

FROM scratch
COPY --from=build /knotdock /knotdock
WORKDIR /data
ENTRYPOINT ["/knotdock"]
