// What ESLint holds JavaScript to.
import js from '@eslint/js';
import globals from 'globals';

const readonly = names => Object.fromEntries(names.map(name => [name, 'readonly']));
// The scripts of a page share their names: those of viewer/, of the packages beside it, and of what web/compose puts in front of them.
const ENGINE = readonly(['createEngine', 'makeCloudbake', 'unpackBytes']);
const VIEWER = readonly(['GlbReader', 'InsideLengths', 'Viewer', 'add', 'circleThrough', 'cross', 'directionFromAngles', 'dot', 'element',
  'insideByLobe', 'noonAzimuthAfter', 'normalize', 'sceneOfGlb', 'sunOfDay', 'viewer']);
const PAGE = { ...VIEWER, ...readonly(['axe', 'baker', 'fflate']) };

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
  { files: ['tests/{browser,engines,web}/*.mjs'], languageOptions: { globals: { ...globals.browser, ...PAGE } } },
  { files: ['web/page/*.js'], languageOptions: { sourceType: 'script', globals: { ...globals.browser, ...ENGINE, ...PAGE } } },
  { files: ['web/cloudbake.js'], languageOptions: { sourceType: 'script', globals: globals['shared-node-browser'] } },
  { files: ['**/engines/npm/*.js'], languageOptions: { globals: globals.browser } },
];
