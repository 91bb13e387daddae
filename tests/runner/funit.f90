module funit
  !! The part of pFUnit 4 that the tests of this project use, under pFUnit's own names, for machines
  !! without it.
  use funit_exceptions, only: SourceLocation, throw, catch, anyExceptions
  use funit_assertions, only: assertEqual, assertNotEqual, assertRelativelyEqual, assertLessThan, &
    assertLessThanOrEqual, assertGreaterThan, assertGreaterThanOrEqual, assertTrue, assertFalse, &
    assertAll, assertAny, assertIsNaN, assertIsFinite, assertSameShape, assertFail, &
    assertExceptionRaised
  use funit_suites, only: TestSuite, suite_runner
  implicit none (type, external)
  public
end module funit
