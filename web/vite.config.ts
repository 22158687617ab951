import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vite";

// The page is built into the Python package; whoever installs the wheel needs no Node.
export default defineConfig({
  plugins: [svelte()],
  base: "/",
  build: {
    outDir: "../python/runglight/server/page",
    emptyOutDir: true,
    target: "es2022",
    // Inlined data would need a wider content security policy.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
  },
  worker: { format: "es" },
  server: { proxy: { "/api": "http://127.0.0.1:8470" } },
});
