// What ESLint holds JavaScript to.
import js from '@eslint/js';
import globals from 'globals';

const readonly = names => Object.fromEntries(names.map(name => [name, 'readonly']));
// What the other scripts of the page that bakes define: the engine's, and those of packages; and in its tests.
const ENGINE = readonly(['createEngine', 'makeCloudbake', 'unpackBytes', 'bytesOfDigits']);
const PAGE = readonly(['axe', 'baker', 'fflate']);

export default [
  js.configs.recommended,
  {
    linterOptions: { reportUnusedDisableDirectives: 'error' },
    rules: {
      complexity: ['error', 15],
      eqeqeq: 'error',
      'no-shadow': 'error',
      'no-unused-vars': ['error', { ignoreRestSiblings: true }],
      'no-var': 'error',
      'object-shorthand': 'error',
      'prefer-const': ['error', { destructuring: 'all' }],
    },
  },
  { files: ['**/*.mjs'], languageOptions: { globals: globals.node } },
  // They have functions that run in a page.
  { files: ['tests/{browser,engines,readers,web}/*.mjs'], languageOptions: { globals: { ...globals.browser, ...PAGE } } },
  { files: ['viewer/**/*.js'], languageOptions: { globals: globals.browser } },
  { files: ['web/page/baker.js'], languageOptions: { globals: { ...globals.browser, ...ENGINE, ...PAGE } } },
  { files: ['web/page/worker.js'], languageOptions: { sourceType: 'script', globals: { ...globals.browser, ...ENGINE } } },
  { files: ['web/cloudbake.js'], languageOptions: { sourceType: 'script', globals: globals['shared-node-browser'] } },
  { files: ['**/engines/npm/*.js'], languageOptions: { globals: globals.browser } },
];
