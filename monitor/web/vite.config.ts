import {defineConfig} from 'vite';

// File names are stable, because `coppice monitor` serves the files of dist/ by name. Nothing is inlined, because its
// Content-Security-Policy allows no inline script, style or font.
export default defineConfig({
  base: './',
  publicDir: 'public',
  build: {
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: {
        entryFileNames: 'app.js',
        assetFileNames: (asset) => (asset.names[0]?.endsWith('.css') ? 'app.css' : '[name][extname]'),
      },
    },
  },
  worker: {
    format: 'es',
    rollupOptions: {output: {entryFileNames: 'background.js'}},
  },
});
