module quad_mesh_samples
  !! Quadrilateral control meshes to test: stars of any valence, boxes, tori, with known surfaces.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, create_quad_mesh, set_interval, next_corner
  use spline_refinement, only: split_faces
  use facet_samples, only: random_stream, uniform
  implicit none (type, external)
  private
  public :: star, grid, torus, box, half_box, cap, half_star, l_shape, finer, &
    uneven, patchwork, framed

  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  function star(n, m) result(mesh)
    !! A regular polygon of n corners, its centre joined to the middles of its sides: n sectors of
    !! m by m faces, bilinear.
    integer, intent(in) :: n, m
    type(quad_mesh_type) :: mesh
    real(wp), allocatable :: x(:,:)
    integer, allocatable :: faces(:,:)
    integer :: f, i, j, k
    character(:), allocatable :: message

    allocate (x(3,1+n*m*(m+1)), source=0.0_wp)
    allocate (faces(4,n*m*m))
    f = 0
    do k = 1, n
      do j = 0, m
        do i = 1, m
          x(1:2,vertex(k, i, j)) = place(k, real(i, wp)/m, real(j, wp)/m)
        end do
      end do
      do j = 1, m
        do i = 1, m
          f = f + 1
          faces(:,f) = [vertex(k, i-1, j-1), vertex(k, i, j-1), vertex(k, i, j), vertex(k, i-1, j)]
        end do
      end do
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'star: the sample has a fault'

  contains

    integer function vertex(k, i, j)
      !! Sector k, i along its first spoke, j along its second; the sector has those with i > 0.
      integer, intent(in) :: k, i, j

      if (i == 0 .and. j == 0) then
        vertex = 1
      else if (i == 0) then
        vertex = 1 + modulo(k, n)*m*(m+1) + j
      else
        vertex = 1 + (k - 1)*m*(m+1) + i + m*j
      end if
    end function vertex

    function place(k, u, v) result(y)
      integer, intent(in) :: k
      real(wp), intent(in) :: u, v
      real(wp) :: y(2), first(2), second(2), corner(2)

      first = cos(pi/n)*[cos(2*pi*(k-1)/n), sin(2*pi*(k-1)/n)]
      second = cos(pi/n)*[cos(2*pi*k/n), sin(2*pi*k/n)]
      corner = [cos(2*pi*(k-0.5_wp)/n), sin(2*pi*(k-0.5_wp)/n)]
      y = u*(1 - v)*first + (1 - u)*v*second + u*v*corner
    end function place
  end function star

  function half_star(n, m) result(mesh)
    !! Half of star(2 n, m): n sectors about a point of the straight boundary.
    integer, intent(in) :: n, m
    type(quad_mesh_type) :: mesh
    type(quad_mesh_type) :: whole
    real(wp), allocatable :: x(:,:)
    integer, allocatable :: new(:)
    integer :: k, nv
    character(:), allocatable :: message

    whole = star(2*n, m)
    allocate (new(whole%nv), source=0)
    allocate (x(3,whole%nv), source=0.0_wp)
    nv = 0
    do k = 1, 4*n*m*m
      if (new(whole%vertex(k)) > 0) cycle
      nv = nv + 1
      new(whole%vertex(k)) = nv
      x(:,nv) = whole%x(:,whole%vertex(k))
    end do
    call create_quad_mesh(x(:,1:nv), reshape(new(whole%vertex(1:4*n*m*m)), [4, n*m*m]), mesh, &
      message)
    if (len(message) > 0) error stop 'half_star: the sample has a fault'
  end function half_star

  function l_shape(m) result(mesh)
    !! Three squares of m by m faces around a corner that points inwards.
    integer, intent(in) :: m
    type(quad_mesh_type) :: mesh
    real(wp), allocatable :: x(:,:)
    integer, allocatable :: faces(:,:), number(:,:)
    integer :: f, i, j, nv
    character(:), allocatable :: message

    allocate (number(0:2*m,0:2*m), source=0)
    allocate (x(3,(2*m+1)**2), source=0.0_wp)
    nv = 0
    do j = 0, 2*m
      do i = 0, 2*m
        if (i > m .and. j > m) cycle
        nv = nv + 1
        number(i,j) = nv
        x(1:2,nv) = [i, j]/real(m, wp) - 1
      end do
    end do
    allocate (faces(4,3*m*m))
    f = 0
    do j = 1, 2*m
      do i = 1, 2*m
        if (i > m .and. j > m) cycle
        f = f + 1
        faces(:,f) = [number(i-1,j-1), number(i,j-1), number(i,j), number(i-1,j)]
      end do
    end do
    call create_quad_mesh(x(:,1:nv), faces, mesh, message)
    if (len(message) > 0) error stop 'l_shape: the sample has a fault'
  end function l_shape

  function grid(n1, n2) result(mesh)
    !! The unit square in n1 by n2 faces.
    integer, intent(in) :: n1, n2
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,(n1+1)*(n2+1))
    integer :: faces(4,n1*n2), i, j, a
    character(:), allocatable :: message

    x = 0
    do j = 0, n2
      do i = 0, n1
        x(1:2,1+i+(n1+1)*j) = [real(i, wp)/n1, real(j, wp)/n2]
      end do
    end do
    do j = 1, n2
      do i = 1, n1
        a = i + (n1+1)*(j-1)
        faces(:,i+n1*(j-1)) = [a, a + 1, a + n1 + 2, a + n1 + 1]
      end do
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'grid: the sample has a fault'
  end function grid

  function torus(n1, n2) result(mesh)
    !! Closed and regular everywhere.
    integer, intent(in) :: n1, n2
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,n1*n2), angle(2)
    integer :: faces(4,n1*n2), i, j
    character(:), allocatable :: message

    do j = 0, n2 - 1
      do i = 0, n1 - 1
        angle = 2*pi*[real(i, wp)/n1, real(j, wp)/n2]
        x(:,1+i+n1*j) = [(2 + cos(angle(2)))*cos(angle(1)), (2 + cos(angle(2)))*sin(angle(1)), &
          sin(angle(2))]
        faces(:,1+i+n1*j) = 1 + [i + n1*j, modulo(i+1, n1) + n1*j, &
          modulo(i+1, n1) + n1*modulo(j+1, n2), i + n1*modulo(j+1, n2)]
      end do
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'torus: the sample has a fault'
  end function torus

  function box() result(mesh)
    !! The surface of the cube [-1,1]^3: eight points of valence 3, two in every edge.
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,8)
    integer, parameter :: faces(4,6) = reshape([1, 3, 4, 2, 5, 6, 8, 7, 1, 2, 6, 5, 3, 7, 8, 4, &
      1, 5, 7, 3, 2, 4, 8, 6], [4, 6])
    integer :: i, j, k
    character(:), allocatable :: message

    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          x(:,1+i+2*j+4*k) = 2*[i, j, k] - 1.0_wp
        end do
      end do
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'box: the sample has a fault'
  end function box

  function cap() result(mesh)
    !! Three faces around a pole and a ring of six below them, in space: the seams of the pole cross
    !! those of the three points of valence 3 around it.
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,13)
    integer :: faces(4,9), k
    character(:), allocatable :: message

    x(:,1) = [0, 0, 1]
    do k = 1, 6
      x(:,1+k) = [0.7_wp*cos(pi*(k-1)/3), 0.7_wp*sin(pi*(k-1)/3), 0.7_wp]
      x(:,7+k) = [cos(pi*(k-1)/3), sin(pi*(k-1)/3), 0.0_wp]
      faces(:,3+k) = [7 + k, 8 + mod(k, 6), 2 + mod(k, 6), 1 + k]
    end do
    do k = 1, 3
      faces(:,k) = [1, 2*k, 2*k + 1, 2 + mod(2*k, 6)]
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'cap: the sample has a fault'
  end function cap

  function half_box() result(mesh)
    !! The upper half of the surface of a cube, vertices on the unit sphere; its rim is open.
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,8)
    integer, parameter :: faces(4,5) = reshape([5, 6, 8, 7, 1, 2, 6, 5, 3, 7, 8, 4, 1, 5, 7, 3, &
      2, 4, 8, 6], [4, 5])
    integer :: i, j, k
    character(:), allocatable :: message

    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          x(:,1+i+2*j+4*k) = [2*i - 1, 2*j - 1, k]/sqrt(2.0_wp + k)
        end do
      end do
    end do
    call create_quad_mesh(x, faces, mesh, message)
    if (len(message) > 0) error stop 'half_box: the sample has a fault'
  end function half_box

  function patchwork(n, stream) result(mesh)
    !! A square with its corners on the unit circle, in n by n squares that are halved along one of
    !! their diagonals at random, every triangle in three faces: points of 3, 5
    !! and more faces inside and on the boundary, two in most faces; straight lines from them cross
    !! everywhere.
    integer, intent(in) :: n
    type(random_stream), intent(inout) :: stream
    type(quad_mesh_type) :: mesh
    integer :: edge((n+1)**2,(n+1)**2), f, faces(4,6*n*n), i, j, k, nv, t(3,2)
    real(wp) :: x(3,6*(n+1)**2)
    character(:), allocatable :: message

    x = 0
    do j = 0, n
      do i = 0, n
        x(1:2,vertex(i, j)) = (2*[i, j] - n)/(n*sqrt(2.0_wp))
        if (min(i, j, n - i, n - j) == 0) cycle
        do k = 1, 2
          x(k,vertex(i, j)) = x(k,vertex(i, j)) + uniform(stream, -0.2_wp, 0.2_wp)/n
        end do
      end do
    end do
    nv = (n + 1)**2
    edge = 0
    f = 0
    do j = 1, n
      do i = 1, n
        if (runs_up(i, j)) then
          t(:,1) = [vertex(i-1, j-1), vertex(i, j-1), vertex(i, j)]
          t(:,2) = [vertex(i-1, j-1), vertex(i, j), vertex(i-1, j)]
        else
          t(:,1) = [vertex(i-1, j-1), vertex(i, j-1), vertex(i-1, j)]
          t(:,2) = [vertex(i, j-1), vertex(i, j), vertex(i-1, j)]
        end if
        do k = 1, 2
          call add_triangle(t(:,k))
        end do
      end do
    end do
    call create_quad_mesh(x(:,1:nv), faces, mesh, message)
    if (len(message) > 0) error stop 'patchwork: the sample has a fault'

  contains

    integer function vertex(i, j)
      integer, intent(in) :: i, j

      vertex = 1 + i + (n + 1)*j
    end function vertex

    logical function runs_up(i, j)
      !! The diagonal, so that corners have one triangle.
      integer, intent(in) :: i, j

      runs_up = uniform(stream, -1.0_wp, 1.0_wp) > 0
      if ((i == 1 .or. i == n) .and. (j == 1 .or. j == n)) runs_up = (i == 1) .neqv. (j == 1)
      if (n == 1) runs_up = .true.
    end function runs_up

    subroutine add_triangle(v)
      integer, intent(in) :: v(3)
      integer :: k, middle(3)

      do k = 1, 3
        middle(k) = middle_of(v(k), v(mod(k, 3) + 1))
      end do
      nv = nv + 1
      x(:,nv) = sum(x(:,v), 2)/3
      do k = 1, 3
        f = f + 1
        faces(:,f) = [v(k), middle(k), nv, middle(mod(k + 1, 3) + 1)]
      end do
    end subroutine add_triangle

    integer function middle_of(a, b)
      integer, intent(in) :: a, b

      if (edge(a,b) == 0) then
        nv = nv + 1
        edge(a,b) = nv
        edge(b,a) = nv
        x(:,nv) = (x(:,a) + x(:,b))/2
      end if
      middle_of = edge(a,b)
    end function middle_of
  end function patchwork

  function framed(square, half) result(mesh)
    !! A square, with sides along the axes and one face in each corner, inside a frame of one row of
    !! faces: boundary vertices have one or two faces.
    type(quad_mesh_type), intent(in) :: square
    real(wp), intent(in) :: half                 !! of the length of a side of the frame
    type(quad_mesh_type) :: mesh
    real(wp) :: x(3,3*square%nv)
    integer :: c, corner, e, f, faces(4,2*square%nf), nv, number(square%nv,4)
    character(:), allocatable :: message

    x(:,1:square%nv) = square%x
    nv = square%nv
    f = square%nf
    faces(:,1:f) = reshape(square%vertex, [4, f])
    number = 0
    do c = 1, 4*square%nf
      if (square%twin(c) > 0) cycle
      associate (v => square%vertex(c), w => square%vertex(next_corner(c)))
        call add_face([w, v, outside(v, side_of(c)), outside(w, side_of(c))])
        ! the corner between this edge and the one that ends here
        e = c - 1 + merge(4, 0, mod(c, 4) == 1)
        if (square%faces(v) > 1) cycle
        nv = nv + 1
        x(1:2,nv) = half*sign(1.0_wp, square%x(1:2,v))
        x(3,nv) = 0
        corner = nv
        call add_face([v, outside(v, side_of(e)), corner, outside(v, side_of(c))])
      end associate
    end do
    call create_quad_mesh(x(:,1:nv), faces(:,1:f), mesh, message)
    if (len(message) > 0) error stop 'framed: the sample has a fault'

  contains

    subroutine add_face(vertices)
      integer, intent(in) :: vertices(4)

      f = f + 1
      faces(:,f) = vertices
    end subroutine add_face

    integer function side_of(corner)
      !! 1, 2: x = -, +; 3, 4: y = -, +
      integer, intent(in) :: corner
      real(wp) :: middle(2)
      integer :: k

      middle = sum(square%x(1:2,square%vertex([corner, next_corner(corner)])), 2)/2
      k = maxloc(abs(middle), 1)
      side_of = 2*k - 1
      if (middle(k) > 0) side_of = 2*k
    end function side_of

    integer function outside(v, side)
      integer, intent(in) :: v, side

      if (number(v,side) == 0) then
        nv = nv + 1
        number(v,side) = nv
        x(:,nv) = square%x(:,v)
        x((side + 1)/2,nv) = merge(half, -half, mod(side, 2) == 0)
      end if
      outside = number(v,side)
    end function outside
  end function framed

  function finer(mesh) result(split)
    !! Every face in four.
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type) :: split
    character(:), allocatable :: message

    call split_faces(mesh, split, message)
    if (len(message) > 0) error stop 'finer: the sample has a fault'
  end function finer

  subroutine uneven(mesh, stream)
    !! Knot intervals between 1/2 and 2.
    type(quad_mesh_type), intent(inout) :: mesh
    type(random_stream), intent(inout) :: stream
    logical :: given(4*mesh%nf)
    character(:), allocatable :: message
    integer :: c

    given = .false.
    do c = 1, 4*mesh%nf
      if (given(c)) cycle
      call set_interval(mesh, mesh%vertex(c), mesh%vertex(next_corner(c)), &
        2.0_wp**uniform(stream, -1.0_wp, 1.0_wp), given, message)
      if (len(message) > 0) error stop 'uneven: the sample has a fault'
    end do
  end subroutine uneven
end module quad_mesh_samples
